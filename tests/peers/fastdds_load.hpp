// What a client of rmw_fastrtps_cpp may expect of ~/move_axis (as conformance.py), and a client that asks for
// everything at once (as hammer.py).
#pragma once

#include <algorithm>

#include "fastdds_move.hpp"

namespace motion {

/// Runs named checks, shows each, and fails with the names of those that did not hold.
class Checklist {
 public:
  template <class T>
  void check(const std::string& name, const T& got, const T& want) {
    check(name, json(got), got == want);
  }
  void check(const std::string& name, const std::string& got, bool ok) {
    Object().add("check", name).add("ok", ok).add("got", Json{got}).show();
    if (!ok) failed_ += (failed_.empty() ? "" : "; ") + name + " (got " + got + ")";
  }
  void close() const {
    if (!failed_.empty()) throw Failure(failed_);
  }

 private:
  std::string failed_;
};

constexpr uint8_t ABORTING = 0, BUFFERED = 1;
constexpr int UNKNOWN = 0, SUCCEEDED = 4, CANCELED = 5, ABORTED = 6;
constexpr int ACCEPTED = 0, UNKNOWN_GOAL = 2, TERMINATED = 3;
constexpr double KEPT_S = 10.0;  // for which a result is kept after the end of its goal

class Conformance {
 public:
  Conformance(Dds& dds, const std::string& node, const std::string& axis) : node_(node), axis_(axis), c_(dds, node) {}

  void run() {
    rejections();
    GoalId first = start().first;
    status("it ends SUCCEEDED", first, {SUCCEEDED});
    auto ended = Clock::now();
    status("a second get_result is served from the cache", first, {SUCCEEDED});
    sleep_ms(100);
    checks_.check("feedback was seen", json(c_.feedback(first).count), c_.feedback(first).count > 0);
    auto& seen = c_.statuses(first);
    checks_.check("its status ends with SUCCEEDED", json(seen), !seen.empty() && seen.back() == "SUCCEEDED");
    checks_.check("a goal id cannot be used twice", Sent(c_.goals.call(goal(1).request(first))).accepted, false);
    cancel_one();
    cancel_several();
    askers();
    another_order();
    late_joiner();
    if (since(ended) < KEPT_S - 1) status("its result is kept", first, {SUCCEEDED});
    while (since(ended) < KEPT_S + 0.2) sleep_ms(10);
    status("after its time the result is gone", first, {UNKNOWN});
    cancels("and the goal is not known", first, {}, UNKNOWN_GOAL, {});
    checks_.close();
  }

 private:
  using Goal = std::pair<GoalId, Stamp>;

  MoveGoal goal(double times) const {
    MoveGoal goal;
    goal.axis = axis_;
    goal.mode = 1;
    goal.position = 0.005 * times;
    goal.velocity = 0.02;
    return goal;
  }

  Goal start(double times = 1, uint8_t buffer_mode = ABORTING) {
    MoveGoal wanted = goal(times);
    wanted.buffer_mode = buffer_mode;
    GoalId id = random_goal();
    Sent sent(c_.goals.call(wanted.request(id)));
    checks_.check("the goal is accepted", sent.accepted, true);
    return {id, sent.stamp};
  }

  static int status_in(const Bytes& reply) { return Reader(reply).get<int8_t>(); }

  void status(const std::string& name, const GoalId& id, const std::vector<int>& wanted) {
    int got = status_in(c_.results.call(MoveClient::result_request(id)));
    checks_.check(name, json(got), std::count(wanted.begin(), wanted.end(), got) > 0);
  }

  void cancels(const std::string& name, const GoalId& id, Stamp stamp, int code, const std::vector<GoalId>& wanted) {
    Canceled got(c_.cancels.call(MoveClient::cancel_request(id, stamp)));
    std::vector<std::string> goals;
    for (auto& one : wanted) goals.push_back(hex(one.data()));
    std::sort(goals.begin(), goals.end());
    std::sort(got.goals.begin(), got.goals.end());
    checks_.check(name, "[" + json(got.code) + ", " + json(got.goals) + "]", got.code == code && got.goals == goals);
  }

  void rejections() {
    std::map<std::string, MoveGoal> wrong;
    auto bad = [&](const std::string& name) -> MoveGoal& { return wrong.emplace(name, goal(1)).first->second; };
    bad("NaN as position").position = std::nan("");
    bad("an infinite position").position = HUGE_VAL;
    bad("NaN as velocity").velocity = std::nan("");
    bad("an unknown axis").axis = "no_such_axis";
    bad("an unknown mode").mode = 200;
    bad("an unknown unit").units = 200;
    bad("an unknown buffer mode").buffer_mode = 200;
    for (auto& [name, goal] : wrong) {
      GoalId id = random_goal();
      checks_.check(name + " is rejected", Sent(c_.goals.call(goal.request(id))).accepted, false);
      status("get_result of a rejected goal is UNKNOWN", id, {UNKNOWN});
    }
    status("get_result of a goal that nobody sent is UNKNOWN", random_goal(), {UNKNOWN});
  }

  void cancel_one() {
    GoalId id = start(100).first;
    sleep_ms(100);
    cancels("a running goal is canceled", id, {}, ACCEPTED, {id});
    status("it ends CANCELED", id, {CANCELED});
    cancels("cancel of a finished goal says so", id, {}, TERMINATED, {});
    cancels("cancel of an unknown goal says so", random_goal(), {}, UNKNOWN_GOAL, {});
  }

  std::vector<Goal> three() { return {start(40), start(40, BUFFERED), start(40, BUFFERED)}; }

  void end(const std::vector<Goal>& goals) {
    for (auto& one : goals) status("it ends, because it or the goal before it was canceled", one.first, {CANCELED, ABORTED});
  }

  void cancel_several() {
    auto goals = three();
    cancels("cancel by time means the goals that were accepted by then", GoalId{}, goals[1].second, ACCEPTED,
            {goals[0].first, goals[1].first});
    status("the last one, which nobody canceled, ends ABORTED", goals[2].first, {ABORTED});
    end(goals);
    goals = three();
    cancels("cancel by id and time means that goal and the older ones", goals[2].first, goals[0].second, ACCEPTED,
            {goals[0].first, goals[2].first});
    end(goals);
    goals = three();
    cancels("cancel without id or time means all goals", GoalId{}, {}, ACCEPTED,
            {goals[0].first, goals[1].first, goals[2].first});
    end(goals);
    cancels("without an open goal it is answered too, with none", GoalId{}, {}, ACCEPTED, {});
  }

  void askers() {
    GoalId id = start().first;
    Dds other;
    MoveClient b(other, node_);
    std::vector<Service*> both{&c_.results, &b.results};
    std::vector<SequenceNumber_t> numbers;
    for (auto one : both) numbers.push_back(one->send(MoveClient::result_request(id)));
    for (size_t i = 0; i < both.size(); i++) {
      wait_until([&] { return both[i]->collect().count(numbers[i]) > 0; }, REPLY_S, "an asker gets no result");
      checks_.check("each of two askers gets the result", status_in(both[i]->collect()[numbers[i]]), SUCCEEDED);
    }
  }

  void another_order() {
    std::vector<Goal> goals;
    for (double times : {1.0, -1.0, 1.0, -1.0}) goals.push_back(start(times, BUFFERED));
    auto& last = goals.back().first;
    wait_until([&] { auto& s = c_.statuses(last); return !s.empty() && s.back() == "SUCCEEDED"; }, REPLY_S,
               "the last of four goals does not end");
    for (int i : {2, 0, 3, 1}) status("a goal has its result after all have ended", goals[i].first, {SUCCEEDED});
  }

  void late_joiner() {
    Dds other;
    MoveClient late(other, node_);
    wait_until([&] { return late.arrays() > 0; }, REPLY_S, "a late joiner gets no status array");
    sleep_ms(500);
    checks_.check("a late joiner gets one status array", late.arrays(), size_t(1));
  }

  std::string node_, axis_;
  MoveClient c_;
  Checklist checks_;
};

/// Requests to one service that wait for their answers.
class Line {
 public:
  using Check = std::function<bool(Reader&)>;
  explicit Line(Service& service) : service_(service) {}
  bool is_full() const { return open_.size() >= 4; }  // the writer keeps ten
  void ask(const Bytes& request, const Check& check) { open_[service_.send(request)] = check; }
  void take() {
    auto& replies = service_.collect();
    for (auto& [number, bytes] : replies) {
      auto found = open_.find(number);
      if (found == open_.end()) {
        strange++;
        continue;
      }
      answered++;
      Reader r(bytes);
      if (!found->second(r)) wrong++;
      open_.erase(found);
    }
    replies.clear();
  }
  size_t lost() const { return open_.size(); }
  size_t twice() const { return service_.twice(); }
  size_t answered = 0, strange = 0, wrong = 0;

 private:
  Service& service_;
  std::map<SequenceNumber_t, Check> open_;
};

class Hammer {
 public:
  Hammer(Service& enables, Service& halts, Service& gets, Service& sets, MoveClient& moves, const std::string& axis,
         unsigned seed)
      : axis_(axis), dice_(seed) {
    for (auto s : {&enables, &halts, &gets, &sets, &moves.goals, &moves.cancels, &moves.results}) lines_.emplace_back(*s);
    for (auto name : {"max_velocity", "max_acceleration", "default_velocity", "default_acceleration", "rampmin"}) {
      std::string full = axis_ + "." + name;
      Bytes reply = gets.call(Writer().put<uint32_t>(1).text(full).bytes());
      Reader r(reply);
      if (r.get<uint32_t>() == 1) values_.emplace_back(full, value(r));
    }
    if (values_.empty()) throw Failure("the axis " + axis_ + " has no parameters");
    Bytes reply = enables.call(axes({axis_}));
    Reader r(reply);
    if (!r.get<uint8_t>()) throw Failure(r.text());
  }

  /// With a `rate`, so many requests a second; with 0 as many as possible.
  void run(double seconds, double rate) {
    size_t asked = 0;
    for (auto start = Clock::now(); since(start) < seconds; take()) {
      if (rate > 0 && asked >= since(start) * rate) {
        sleep_ms(2);
        continue;
      }
      ask();
      asked++;
    }
    for (auto start = Clock::now(); lost() > 0 && since(start) < REPLY_S; sleep_ms(1)) take();
    sleep_ms(300);
    take();
    size_t answered = 0, twice = 0, strange = 0, wrong = 0;
    std::vector<size_t> each;
    for (auto& line : lines_) {
      answered += line.answered, twice += line.twice(), strange += line.strange, wrong += line.wrong;
      each.push_back(line.answered);
    }
    Object().add("answered", answered).add("twice", twice).add("strange", strange).add("lost", lost())
        .add("wrong", wrong).add("each", each).show();
    if (twice || strange || wrong || lost()) throw Failure("answers were lost, doubled or wrong");
  }

 private:
  static Bytes axes(const std::vector<std::string>& names) {
    Writer w;
    w.put<uint32_t>(names.size());
    for (auto& name : names) w.text(name);
    return w.bytes();
  }

  /// A ParameterValue as (type, integer, double, text).
  using Value = std::tuple<int, int64_t, double, std::string>;
  static Value value(Reader& r) {
    int type = r.get<uint8_t>();
    r.get<uint8_t>();
    auto integer = r.get<int64_t>();
    auto number = r.get<double>();
    auto text = r.text();
    for (int arrays = 0; arrays < 5; arrays++)
      if (r.get<uint32_t>() > 0) throw Failure("a value with an array in it");
    return {type, integer, number, text};
  }

  size_t die(size_t sides) { return std::uniform_int_distribution<size_t>(0, sides - 1)(dice_); }
  std::string none() { return "none_" + std::to_string(die(1000000000)); }

  void ask() {
    size_t which = die(lines_.size());
    Line& line = lines_[which];
    if (line.is_full()) return;
    bool good = die(2) == 0;
    switch (which) {
      case 0:
      case 1: {
        std::string wrong = none();
        line.ask(good ? axes({axis_}) : axes({axis_, wrong}), [=](Reader& r) {
          bool success = r.get<uint8_t>() != 0;
          // Halting ends unsuccessfully where a goal of the same client takes the axis over.
          std::string message = r.text();
          return good ? success || message.rfind(axis_ + ": ", 0) == 0
                      : !success && message.find(wrong) != std::string::npos;
        });
        break;
      }
      case 2: {
        std::vector<std::string> names;
        std::vector<Value> wanted;
        for (size_t n = 1 + die(8); n > 0; n--) {
          auto& one = values_[die(values_.size())];
          names.push_back(one.first);
          wanted.push_back(one.second);
        }
        line.ask(axes(names), [=](Reader& r) { return r.sequence<Value>(&Hammer::value) == wanted; });
        break;
      }
      case 3: {
        // The parameter of its own axis, which nobody else sets.
        std::string wrong = axis_ + "." + none(), name = good ? axis_ + ".velocity_override" : wrong;
        Writer w;
        put_double(w.put<uint32_t>(1).text(name), 10.0 + die(90));
        line.ask(w.bytes(), [=](Reader& r) {
          if (r.get<uint32_t>() != 1) return false;
          bool success = r.get<uint8_t>() != 0;
          return good ? success : !success && r.text().find(wrong) != std::string::npos;
        });
        break;
      }
      case 4: {
        MoveGoal goal;
        goal.axis = good ? axis_ : none();
        goal.mode = 1;
        goal.position = (static_cast<double>(die(4001)) - 2000) * 1e-6;
        GoalId id = random_goal();
        line.ask(goal.request(id), [=](Reader& r) {
          bool accepted = r.get<uint8_t>() != 0;
          if (accepted) goals_.emplace_back(Clock::now(), id);
          if (goals_.size() > 100) goals_.erase(goals_.begin());
          return accepted == good;
        });
        break;
      }
      case 5: {
        bool known = good && !goals_.empty();
        GoalId id = known ? goals_[die(goals_.size())].second : random_goal();
        line.ask(MoveClient::cancel_request(id), [=](Reader& r) {
          int code = r.get<int8_t>();
          return known ? code == ACCEPTED || code == TERMINATED || code == UNKNOWN_GOAL : code == UNKNOWN_GOAL;
        });
        break;
      }
      default: {
        bool known = good && !goals_.empty();
        GoalId id = known ? goals_.back().second : random_goal();
        // Of all clients 256 results are kept: one who asks late may be too late.
        auto accepted = known ? goals_.back().first : Clock::now();
        if (known) goals_.pop_back();
        line.ask(MoveClient::result_request(id), [=](Reader& r) {
          int status = r.get<int8_t>();
          bool late = since(accepted) > 0.02;
          return known ? (status >= SUCCEEDED && status <= ABORTED) || (late && status == UNKNOWN) : status == UNKNOWN;
        });
      }
    }
  }

  static void put_double(Writer& w, double value) {
    w.put<uint8_t>(3).put<uint8_t>(0).put<int64_t>(0).put<double>(value).text("");
    for (int arrays = 0; arrays < 5; arrays++) w.put<uint32_t>(0);
  }

  void take() {
    for (auto& line : lines_) line.take();
  }
  size_t lost() const {
    size_t lost = 0;
    for (auto& line : lines_) lost += line.lost();
    return lost;
  }

  std::string axis_;
  std::mt19937 dice_;
  std::vector<Line> lines_;
  std::vector<std::pair<std::string, Value>> values_;
  std::vector<std::pair<Clock::time_point, GoalId>> goals_;  // accepted, and not asked for yet
};

}  // namespace motion
