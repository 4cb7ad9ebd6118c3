// Clients of the joints of a group as rmw_fastrtps_cpp speaks for them: FollowJointTrajectory, GripperCommand, JointJog, the controller
// manager; and the parts of an action that all clients have.
#pragma once

#include "fastdds_move.hpp"

namespace joints {

using namespace motion;

/// The parts of an action that a client calls, without feedback and status.
struct Action {
  Action(Dds& dds, const std::string& name, const std::string& type)
      : goals(dds, name + "/_action/send_goal", type + "_SendGoal"),
        results(dds, name + "/_action/get_result", type + "_GetResult") {}

  /// Sends a goal, whose bytes follow those of its id, and waits for its end: the status, and what `read` takes from the result.
  template <class Put, class Read>
  void run(Put put, Read read) {
    finish(send(put), read);
  }

  template <class Put>
  GoalId send(Put put) {
    GoalId id = random_goal();
    Writer w;
    put(w.raw(id.data(), id.size()));
    if (!Sent(goals.call(w.bytes())).accepted) throw Failure("the goal was rejected");
    return id;
  }

  /// The status.
  template <class Read>
  std::string finish(const GoalId& id, Read read) {
    Bytes reply = results.call(MoveClient::result_request(id), RESULT_S);
    Reader r(reply);
    Object seen;
    auto status = STATUS.at(r.get<int8_t>());
    read(r, seen.add("status", status));
    seen.show();
    return status;
  }

  Service goals, results;
};

inline std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> all;
  std::istringstream words(text);
  for (std::string word; std::getline(words, word, at);) all.push_back(word);
  return all;
}

inline void put_numbers(Writer& w, const std::string& text) {
  auto all = split(text, ',');
  w.put<uint32_t>(all.size());
  for (auto& one : all) w.put<double>(std::stod(one));
}

inline void put_texts(Writer& w, const std::vector<std::string>& all) {
  w.put<uint32_t>(all.size());
  for (auto& one : all) w.text(one);
}

/// So many seconds from now by the system clock; {} is no stamp.
inline Stamp from_now(double seconds) {
  auto now = std::chrono::system_clock::now().time_since_epoch();
  auto ns = std::chrono::duration_cast<std::chrono::nanoseconds>(now).count() + std::llround(seconds * 1e9);
  return {static_cast<int32_t>(ns / 1000000000), static_cast<uint32_t>(ns % 1000000000)};
}

inline void put_header(Writer& w, Stamp stamp) { w.put(stamp.sec).put(stamp.nanosec).text(""); }

inline void put_duration(Writer& w, double seconds) {
  auto whole = static_cast<int32_t>(std::floor(seconds));
  w.put<int32_t>(whole).put<uint32_t>(static_cast<uint32_t>(std::lround((seconds - whole) * 1e9)));
}

/// trajectory_msgs/JointTrajectory; each point is SECONDS:POSITIONS[:VELOCITIES[:ACCELERATIONS]], with numbers between commas.
inline void put_trajectory(Writer& w, const std::vector<std::string>& names, const std::vector<std::string>& points,
                           Stamp start = {}) {
  put_header(w, start);
  put_texts(w, names);
  w.put<uint32_t>(points.size());
  for (auto& point : points) {
    auto parts = split(point, ':');
    parts.resize(5);
    for (size_t i = 1; i < 5; i++) put_numbers(w, parts[i]);  // the last one: no efforts
    put_duration(w, std::stod(parts[0]));
  }
}

inline void put_follow_goal(Writer& w, const std::vector<std::string>& names, const std::vector<std::string>& points,
                            Stamp start) {
  put_trajectory(w, names, points, start);
  put_trajectory(w, {}, {});  // multi_dof_trajectory
  for (int list = 0; list < 4; list++) w.put<uint32_t>(0);
  put_duration(w, 0.0);
}

/// control_msgs/JointJog for one joint, without a stamp.
inline Bytes jog(const std::string& joint, double velocity) {
  Writer w;
  put_header(w, {});
  put_texts(w, {joint});
  w.put<uint32_t>(0).put<uint32_t>(1).put(velocity);
  return w.put<double>(0.0).bytes();
}

/// controller_manager_msgs/ControllerState: its name, state and type.
inline Json controller(Reader& r) {
  auto text = [](Reader& r) { return r.text(); };
  Object seen;
  for (auto key : {"name", "state", "type"}) seen.add(key, r.text());
  r.get<uint8_t>();
  r.get<uint16_t>();
  seen.add("claimed_interfaces", r.sequence<std::string>(text));
  for (int list = 0; list < 2; list++) r.sequence<std::string>(text);
  for (int flag = 0; flag < 2; flag++) r.get<uint8_t>();
  for (int list = 0; list < 2; list++) r.sequence<std::string>(text);
  r.sequence<Json>([&](Reader& r) {
    r.text();
    r.sequence<std::string>(text);
    return Json{""};
  });
  return seen.done();
}

}  // namespace joints
