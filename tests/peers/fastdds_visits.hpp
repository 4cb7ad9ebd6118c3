// Participants that come, read what a node has latched, call it once and go, as the tools of ROS 2 on rmw_fastrtps_cpp do.
//
// A reader of Fast DDS 2.6 to 2.14 that has some fragments of a sample and then a GAP over it loops for ever with its lock held. So
// the process watches itself.
#pragma once

#include <atomic>

#include "fastdds_wire.hpp"

namespace wire {

constexpr double VISIT_S = 30.0;  // far more than a visit takes

/// Ends the process with a failure when nothing is reported for too long.
class Watchdog {
 public:
  Watchdog() : thread_([this] { watch(); }) {}
  ~Watchdog() {
    ends_ = true;
    thread_.join();
  }
  void alive(size_t visit) {
    visit_ = visit;
    last_ = Clock::now();
  }

 private:
  void watch() {
    for (; !ends_; sleep_ms(50)) {
      if (since(last_) < VISIT_S) continue;
      auto what = "visit " + std::to_string(visit_) + " hangs: a reader of Fast DDS does not return";
      Object().add("done", "visits").add("ok", false).add("error", what).show();
      std::_Exit(3);
    }
  }
  std::atomic<bool> ends_{false};
  std::atomic<size_t> visit_{0};
  std::atomic<Clock::time_point> last_{Clock::now()};
  std::thread thread_;
};

/// Takes samples as rmw_fastrtps_cpp does.
class Latest {
 public:
  Latest(Dds& dds, const std::string& topic, const std::string& type) : reader_(dds.reader(topic, type, true)) {}
  bool came() {
    LoanableSequence<Bytes> values(1);
    SampleInfoSeq infos(1);
    while (reader_->take(values, infos, 1) == ReturnCode_t::RETCODE_OK) {
      if (infos[0].valid_data) length_ = values[0].size();
      values.length(0);
      infos.length(0);
    }
    return length_ > 0;
  }
  size_t length() const { return length_; }

 private:
  DataReader* reader_;
  size_t length_ = 0;
};

/// One visit: times in s until the graph, the robot and the first answer were there.
struct Visit {
  double graph_s = -1, robot_s = -1, call_s = -1;

  Visit(const std::string& node, const std::string& axis) {
    Dds dds;
    auto start = Clock::now();
    Latest graph(dds, "ros_discovery_info", "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_");
    Latest robot(dds, "rt/robot_description", "std_msgs::msg::dds_::String_");
    Service service(dds, node + "/reset_errors", "lineshaft_msgs::srv::dds_::AxesCommand");
    Writer w;
    w.put<uint32_t>(1);
    w.text(axis);
    auto asked = Clock::now();
    service.call(w.bytes());
    call_s = since(asked);
    wait_until([&] {
      if (graph_s < 0 && graph.came()) graph_s = since(start);
      if (robot_s < 0 && robot.came()) robot_s = since(start);
      return graph_s >= 0 && robot_s >= 0;
    }, REPLY_S, "ros_discovery_info or robot_description is missing");
    // A fragment that is repeated comes within this time.
    for (auto end = Clock::now(); since(end) < 0.15; sleep_ms(5)) graph.came(), robot.came();
  }
};

inline void visits(const std::string& node, const std::string& axis, size_t count) {
  Watchdog watchdog;
  std::vector<double> graph, robot, call;
  for (size_t i = 0; i < count; i++) {
    watchdog.alive(i);
    Visit visit(node, axis);
    graph.push_back(visit.graph_s);
    robot.push_back(visit.robot_s);
    call.push_back(visit.call_s);
  }
  Object().add("visits", count).add("graph_s", graph).add("robot_s", robot).add("call_s", call).show();
}

}  // namespace wire
