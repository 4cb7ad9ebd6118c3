// ~/move_axis as a client of rmw_fastrtps_cpp speaks to it.
#pragma once

#include <array>
#include <random>

#include "fastdds_wire.hpp"

namespace motion {

using namespace wire;

using GoalId = std::array<uint8_t, 16>;

inline GoalId random_goal() {
  static std::random_device source;
  GoalId id;
  for (auto& byte : id) byte = source();
  return id;
}

inline std::string hex(const uint8_t* p) {
  static const char* digits = "0123456789abcdef";
  std::string out;
  for (int i = 0; i < 16; i++) (out += digits[p[i] >> 4]) += digits[p[i] & 15];
  return out;
}

inline GoalId from_hex(const std::string& text) {
  GoalId id;
  if (text.size() != 2 * id.size()) throw Failure("a goal id has 32 hexadecimal digits, not " + text);
  for (size_t i = 0; i < id.size(); i++) id[i] = std::stoul(text.substr(2 * i, 2), nullptr, 16);
  return id;
}

inline const std::vector<std::string> MODES{"absolute", "relative", "additive", "velocity", "superimposed"};
inline const std::vector<std::string> UNITS{"si", "axis_unit", "increments"};
inline const std::vector<std::string> EDGES{"rising", "falling", "both", "index"};
inline const std::vector<std::string> STATUS{"UNKNOWN",   "ACCEPTED", "EXECUTING", "CANCELING",
                                      "SUCCEEDED", "CANCELED", "ABORTED"};

struct MoveGoal {
  std::string axis;
  uint8_t mode = 0, units = 0;
  double position = 0, velocity = 0, acceleration = 0, deceleration = 0, jerk = 0;
  uint8_t buffer_mode = 0, direction = 0;

  Bytes request(const GoalId& id) const {
    Writer w;
    w.raw(id.data(), id.size()).text(axis).put(mode).put(units);
    for (double v : {position, velocity, acceleration, deceleration, jerk}) w.put(v);
    return w.put(buffer_mode).put(direction).bytes();
  }
};

/// A goal of ~/probe_axis, for a mark on the way to a position in SI units.
struct ProbeGoal {
  std::string axis, event;
  uint8_t edge = 0;
  double position = 0, velocity = 0, distance = 0;

  void put(Writer& w) const {
    w.text(axis).put<uint8_t>(0).put<uint8_t>(0);
    for (double v : {position, velocity, 0.0, 0.0, 0.0}) w.put(v);
    w.text(event).put(edge).put(distance);
  }
};

struct Feedback {
  size_t count = 0;
  double position = 0, velocity = 0, distance_to_go = 0;
  int64_t increments = 0;
};

struct Stamp {
  int32_t sec = 0;
  uint32_t nanosec = 0;
};

/// An answer to send_goal.
struct Sent {
  explicit Sent(const Bytes& reply) {
    Reader r(reply);
    accepted = r.get<uint8_t>() != 0;
    stamp.sec = r.get<int32_t>();
    stamp.nanosec = r.get<uint32_t>();
  }
  bool accepted;
  Stamp stamp;
};

/// An answer to cancel_goal.
struct Canceled {
  explicit Canceled(const Bytes& reply) {
    Reader r(reply);
    code = r.get<int8_t>();
    goals = r.sequence<std::string>([](Reader& r) {
      auto goal = hex(r.take(16));
      r.get<int32_t>();
      r.get<uint32_t>();
      return goal;
    });
  }
  int code;
  std::vector<std::string> goals;
};

class MoveClient {
 public:
  MoveClient(Dds& dds, const std::string& node)
      : goals(dds, node + "/move_axis/_action/send_goal", TYPE + "SendGoal"),
        results(dds, node + "/move_axis/_action/get_result", TYPE + "GetResult"),
        cancels(dds, node + "/move_axis/_action/cancel_goal", "action_msgs::srv::dds_::CancelGoal"),
        feedback_(dds, node + "/move_axis/_action/feedback", TYPE + "FeedbackMessage_"),
        status_(dds, node + "/move_axis/_action/status", "action_msgs::msg::dds_::GoalStatusArray_", true) {}

  static Bytes result_request(const GoalId& id) { return Writer().raw(id.data(), id.size()).bytes(); }
  static Bytes cancel_request(const GoalId& id, Stamp stamp = {}) {
    return Writer().raw(id.data(), id.size()).put(stamp.sec).put(stamp.nanosec).bytes();
  }

  GoalId send(const MoveGoal& goal) {
    GoalId id = random_goal();
    bool accepted = Sent(goals.call(goal.request(id))).accepted;
    Object().add("goal", hex(id.data())).add("accepted", accepted).show();
    if (!accepted) throw Failure("the goal was rejected");
    return id;
  }

  void cancel(const GoalId& id) {
    Canceled c(cancels.call(cancel_request(id)));
    Object().add("cancel", c.code).add("canceling", c.goals).show();
    if (c.code) throw Failure("cancel was answered with code " + std::to_string(c.code));
  }

  void finish(const GoalId& id, const std::string& expected) {
    Bytes reply = results.call(result_request(id), RESULT_S);
    Reader r(reply);
    std::string status = STATUS.at(r.get<int8_t>());
    auto code = r.get<uint32_t>();
    auto message = r.text();
    auto position = r.get<double>();
    auto increments = r.get<int64_t>();
    sleep_ms(50);  // feedback and status are other topics: let what was sent before the result arrive
    const Feedback& f = feedback(id);
    Object last, result, feedback;
    last.add("position", f.position).add("velocity", f.velocity).add("distance_to_go", f.distance_to_go);
    last.add("position_increments", f.increments);
    feedback.add("count", f.count).add("last", f.count ? last.done() : Json{"null"});
    result.add("code", code).add("message", message).add("position", position).add("position_increments", increments);
    Object().add("status", status).add("result", result.done()).add("feedback", feedback.done())
        .add("statuses", statuses_[hex(id.data())]).show();
    if (status != expected) throw Failure("the goal ended " + status + ", not " + expected + ": " + message);
  }

  /// Of one goal, so far.
  const Feedback& feedback(const GoalId& id) { return collect(), seen_[hex(id.data())]; }
  const std::vector<std::string>& statuses(const GoalId& id) { return collect(), statuses_[hex(id.data())]; }
  /// Status arrays so far.
  size_t arrays() { return collect(), arrays_; }

  Service goals, results, cancels;

 private:
  static inline const std::string TYPE = "lineshaft_msgs::action::dds_::MoveAxis_";

  void collect() {
    feedback_.drain([&](Reader& r) {
      Feedback& f = seen_[hex(r.take(16))];
      f.count++;
      f.position = r.get<double>();
      f.velocity = r.get<double>();
      f.distance_to_go = r.get<double>();
      f.increments = r.get<int64_t>();
    });
    status_.drain([&](Reader& r) {
      arrays_++;
      for (auto n = r.get<uint32_t>(); n > 0; n--) {
        auto goal = hex(r.take(16));
        r.get<int32_t>();
        r.get<uint32_t>();
        statuses_[goal].push_back(STATUS.at(r.get<int8_t>()));
      }
    });
  }

  Subscription feedback_, status_;
  size_t arrays_ = 0;
  std::map<std::string, Feedback> seen_;
  std::map<std::string, std::vector<std::string>> statuses_;
};

}  // namespace motion
