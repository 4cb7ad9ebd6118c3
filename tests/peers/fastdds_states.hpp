// States of axes, events, and the stamps of topics while the system clock is set, as subscribers of rmw_fastrtps_cpp see them.
#pragma once

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <memory>

#include "fastdds_wire.hpp"

namespace states {

using namespace wire;

inline const std::vector<std::string> AXIS_STATES{"DISABLED", "STANDSTILL",          "DISCRETE_MOTION", "CONTINUOUS_MOTION",
                                                  "HOMING",   "SYNCHRONIZED_MOTION", "STOPPING",        "ERROR_STOP"};
constexpr uint32_t CLOCK_STEPPED = 10372;
constexpr double STEP_S = 15.0;  // far more than stamps take to follow the system clock

inline double system_time() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

// libfaketime may set the clock of this process, too, from its start on; it leaves the steady one alone.
inline const Clock::time_point START = Clock::now();
inline const double REAL = system_time();
inline double real_time() { return REAL + since(START); }

/// A builtin_interfaces/Time as {"sec": .., "nanosec": ..}.
inline Json stamp(Reader& r) {
  Object seen;
  seen.add("sec", r.get<int32_t>());
  return seen.add("nanosec", r.get<uint32_t>()).done();
}

/// An AxisState after its name.
inline Json axis_state(Reader& r) {
  Object seen;
  seen.add("state", AXIS_STATES.at(r.get<uint8_t>()));
  for (auto key : {"drive_state", "reference"}) seen.add(key, r.get<uint8_t>());
  seen.add("mode_of_operation", r.get<int8_t>());
  for (auto key : {"enabled", "homed", "in_position", "in_velocity", "in_sync", "warning", "positive_limit", "negative_limit"})
    seen.add(key, r.get<uint8_t>() != 0);
  seen.add("error_code", r.get<uint32_t>());
  for (auto key : {"command_position", "command_velocity", "command_acceleration", "position", "velocity", "effort",
                   "following_error", "sync_error"})
    seen.add(key, r.get<double>());
  for (auto key : {"command_increments", "position_increments", "following_error_increments", "sync_error_increments"})
    seen.add(key, r.get<int64_t>());
  return seen.done();
}

/// An AxisStates message, with the axes by their names.
inline Object axis_states(Reader& r) {
  Object message, axes;
  message.add("stamp", stamp(r));
  r.text();
  message.add("cycle", r.get<uint64_t>());
  for (auto n = r.get<uint32_t>(); n > 0; n--) {
    auto name = r.text();
    axes.add(name, axis_state(r));
  }
  return message.add("axes", axes.done());
}

/// An Event message.
struct Event {
  explicit Event(Reader& r) {
    message.add("stamp", stamp(r));
    r.text();
    for (auto key : {"sequence", "cycle"}) message.add(key, r.get<uint64_t>());
    message.add("age_ns", r.get<uint32_t>()).add("severity", r.get<uint8_t>());
    kind = r.text();
    message.add("kind", kind).add("source", r.text());
    code = r.get<uint32_t>();
    message.add("code", code).add("increments", r.get<int64_t>());
    for (auto key : {"fraction", "value"}) message.add(key, r.get<double>());
    text = r.text();
    message.add("text", text);
  }
  Object message;
  std::string kind, text;
  uint32_t code = 0;
};

// ---- Steps of the system clock, as in clock.py

/// A topic whose messages begin with a stamp: how far that is ahead of the real time.
class Watched {
 public:
  Watched(Dds& dds, const std::string& topic, const std::string& type) : topic(topic), subscription_(dds, topic, type) {}
  template <class Each>
  void take(Each each) {
    subscription_.drain([&](Reader& r) {
      Reader head = r;
      double stamp = head.get<int32_t>();
      stamp += 1e-9 * head.get<uint32_t>();
      if (count_++ > 0) back = std::min(back, stamp - last_);
      last_ = stamp;
      ahead = stamp - real_time();
      each(r);
    });
  }
  size_t take() { return take([](Reader&) {}), count_; }

  const std::string topic;
  double ahead = 0, back = 0;

 private:
  Subscription subscription_;
  double last_ = 0;
  size_t count_ = 0;
};

class ClockSteps {
 public:
  /// `refuse` makes a call that the node refuses with an event and a line.
  ClockSteps(Dds& dds, const std::string& node, const std::string& file, double ahead, std::function<void()> refuse)
      : file_(file), before_(ahead), refuse_(refuse), events_(dds, node + "/events", "lineshaft_msgs::msg::dds_::Event_"),
        lines_(dds, "/rosout", "rcl_interfaces::msg::dds_::Log_") {
    auto watch = [&](const std::string& topic, const std::string& type) {
      topics_.push_back(std::make_unique<Watched>(dds, topic, type));
    };
    watch("/joint_states", "sensor_msgs::msg::dds_::JointState_");
    watch(node + "/axis_states", "lineshaft_msgs::msg::dds_::AxisStates_");
    watch("/diagnostics", "diagnostic_msgs::msg::dds_::DiagnosticArray_");
    watch(node + "/cycle_statistics", "lineshaft_msgs::msg::dds_::CycleStatistics_");
    wait_until([&] {
      bool came = true;
      for (auto& one : topics_) came = one->take() > 0 && came;
      return came;
    }, REPLY_S, "no samples");
  }

  /// Sets the clock by so many seconds: one event reports it, then all topics show it.
  void step(double by) {
    events_.take(), lines_.take();
    for (auto& one : topics_) one->take(), one->back = 0;
    reported_.clear();
    set_clock(before_ + by);
    std::set<std::string> shown;
    wait_until([&] {
      take_events(by);
      for (auto& one : topics_) {
        one->take();
        if (shown.count(one->topic) || !shows(*one, by)) continue;
        shown.insert(one->topic);
        take_events(by);  // it may have come since
        if (reported_.empty()) throw Failure(one->topic + " shows the step before its event");
      }
      return shown.size() == topics_.size();
    }, STEP_S, "a topic does not show the step of " + std::to_string(by) + " s");
    if (reported_.size() != 1)
      throw Failure(std::to_string(reported_.size()) + " events report the step of " + std::to_string(by) + " s");
    // But for the step itself no stamp goes back.
    for (auto& one : topics_)
      if (one->back < std::min(by, 0.0) - 1e-3)
        throw Failure("stamps of " + one->topic + " go back by " + std::to_string(-one->back));
    before_ += by;
    refusal_shows(by);
    std::vector<std::string> topics(shown.begin(), shown.end());
    Object().add("step", by).add("event", reported_.front()).add("topics", topics).show();
  }

 private:
  // libfaketime reads the file for each reading of the system clock.
  void set_clock(double ahead) const {
    std::ofstream(file_ + ".new") << std::showpos << std::fixed << ahead << "\n";
    if (std::rename((file_ + ".new").c_str(), file_.c_str()) != 0) throw Failure(file_ + " cannot be written");
  }

  bool shows(const Watched& one, double by) const { return std::abs(one.ahead - before_ - by) < std::abs(by) / 2; }

  void take_events(double by) {
    events_.take([&](Reader& r) {
      Event event(r);
      if (event.code != CLOCK_STEPPED) return;
      if (shows(events_, by)) throw Failure("the event of the step shows it already");
      reported_.push_back(event.message.done());
    });
  }

  // What is refused and logged from now on shows the step, too.
  void refusal_shows(double by) {
    auto events = events_.take(), lines = lines_.take();
    refuse_();
    wait_until([&] {
      bool came = events_.take() > events;
      return lines_.take() > lines && came;
    }, REPLY_S, "no refusal");
    for (auto one : {&events_, &lines_})
      if (std::abs(one->ahead - before_) > std::abs(by) / 2)
        throw Failure(one->topic + " is " + std::to_string(one->ahead) + " s ahead, not " + std::to_string(before_));
  }

  std::string file_;
  double before_;
  std::function<void()> refuse_;
  Watched events_, lines_;
  std::vector<std::unique_ptr<Watched>> topics_;
  std::vector<Json> reported_;
};

}  // namespace states
