// A ROS 2 peer on Fast DDS 2 for the end-to-end tests: one JSON line per observation, exit 1 on failure.
//
// The messages are written and read here byte by byte, from docs/contract.md, section 7.
#include "fastdds_joints.hpp"
#include "fastdds_load.hpp"
#include "fastdds_move.hpp"
#include "fastdds_states.hpp"
#include "fastdds_values.hpp"
#include "fastdds_visits.hpp"

using namespace motion;
using namespace values;

namespace {

const char* const USAGE =
    "usage: fastdds_peer COMMAND [ARGUMENT..], the domain from ROS_DOMAIN_ID\n"
    "  joint-states [--seconds 3] [--count N]\n"
    "  axis-states NODE    the next message\n"
    "  events NODE [--seconds 0] [--until KIND]    all since the last call, and those of some seconds\n"
    "  clock-steps NODE FILE SECONDS.. [--ahead 0]    FAKETIME_TIMESTAMP_FILE of the node\n"
    "  axes NODE enable|disable|halt|quick_stop|reset_errors [AXIS..]\n"
    "  move NODE --axis A [--mode absolute] [--units si] [--position P] [--velocity V] [--buffer-mode N]\n"
    "       [--cancel-after S] [--wait]\n"
    "  probe NODE --axis A --event E [--edge rising] [--position P] [--velocity V] [--distance D] [--expect SUCCEEDED]\n"
    "  stream NODE jog --axis A=V [--seconds 0] [--rate 50]    one message at least\n"
    "  vocabulary NODE AXIS VERB [ARGUMENTS..]\n"
    "  params NODE get|describe NAME..\n"
    "  params NODE set|set_atomically NAME=VALUE..\n"
    "  function NODE NAME reset|start|value_new|read_value|NUMBER [FIELD=VALUE..]\n"
    "  functions NODE    the next message of ~/functions\n"
    "  load-table NODE TABLE [--x N,N..] [--y N,N..]\n"
    "  load-long-table NODE TABLE [--count 65536]    and reads it back\n"
    "  get-table NODE TABLE\n"
    "  follow NODE[/GROUP] JOINT,JOINT.. SECONDS:POSITIONS[:VELOCITIES[:ACCELERATIONS]].. [--start S] [--leave]\n"
    "      numbers between commas; --start from now; --leave: does not wait for the end\n"
    "  query-state NODE[/GROUP] NANOSECONDS    since the epoch\n"
    "  gripper NODE/GROUP POSITION\n"
    "  controllers MANAGER    and which are active\n"
    "  switch-controllers MANAGER activate|deactivate NAME..\n"
    "  touch-probe NODE AXIS EVENT    armed for the next rising edge\n"
    "  set-position NODE AXIS POSITION [--relative 1]\n"
    "  result NODE move_axis GOAL [--expect SUCCEEDED]\n"
    "  cancel NODE move_axis GOAL\n"
    "  bad-requests NODE [--axis x]\n"
    "  action-conformance NODE [--axis x]\n"
    "  newcomer NODE [--axis x]    a participant of its own: how long until the node has answered it\n"
    "  visits NODE [--axis x] [--count 10]    participants, one after the other: the latched topics, and one call\n"
    "  readers TOPIC TYPE COUNT    of a writer that is made here: waits until it has so many\n"
    "  samples TOPIC TYPE [--seconds 1] [--latched 1]    how many come to a reader that is kept\n"
    "  hammer NODE [--axis x] [--seconds 10] [--seed 1] [--rate PER_SECOND]\n"
    "  serve    such lines from standard input; after each {\"done\": command, \"ok\": bool, \"error\": sentence}\n";

// ---- Commands

class Arguments {
 public:
  explicit Arguments(std::istream& words) {
    for (std::string word; words >> word;) {
      if (word.rfind("--", 0) != 0) plain_.push_back(word);
      else if (word == "--wait" || word == "--leave") named_[word];
      else if (!(words >> named_[word])) throw Failure(word + " needs a value");
    }
  }
  bool has(const std::string& name) const { return named_.count(name) > 0; }
  std::string text(const std::string& name, const std::string& otherwise) const {
    auto found = named_.find(name);
    return found == named_.end() ? otherwise : found->second;
  }
  double number(const std::string& name, double otherwise) const {
    return has(name) ? std::stod(named_.at(name)) : otherwise;
  }
  uint8_t choice(const std::string& name, const std::vector<std::string>& all) const {
    auto word = text(name, all.front());
    for (size_t i = 0; i < all.size(); i++)
      if (all[i] == word) return i;
    throw Failure(name + " cannot be " + word);
  }
  const std::string& operator[](size_t i) const {
    if (i >= plain_.size()) throw Failure(std::string("an argument is missing\n") + USAGE);
    return plain_[i];
  }
  std::vector<std::string> from(size_t i) const {
    return i < plain_.size() ? std::vector<std::string>(plain_.begin() + i, plain_.end()) : std::vector<std::string>();
  }

 private:
  std::vector<std::string> plain_;
  std::map<std::string, std::string> named_;
};

class Peer {
 public:
  void run(const std::string& line) {
    std::istringstream words(line);
    Arguments a(words);
    auto found = COMMANDS.find(a[0]);
    if (found == COMMANDS.end()) throw Failure("unknown command " + a[0] + "\n" + USAGE);
    (this->*found->second)(a);
  }

 private:
  void joint_states(const Arguments& a) {
    auto& s = once(joints_, "", [&] {
      return new Subscription(dds_, "/joint_states", "sensor_msgs::msg::dds_::JointState_");
    });
    s.drain([](Reader&) {});
    double seconds = a.number("--seconds", 3.0), count = a.number("--count", 1e9), first = -1, last = -1;
    size_t n = 0;
    Object message;
    for (auto start = Clock::now(); n < count && since(start) < seconds; sleep_ms(1)) {
      s.drain([&](Reader& r) {
        last = since(start);
        if (n++ == 0) first = last;
        message = joint_state(r);
      });
    }
    if (n == 0) throw Failure("no joint states");
    double rate = n > 1 && last > first ? (n - 1) / (last - first) : 0.0;
    Object().add("received", n).add("first_s", first).add("rate", rate).add("last", message.done()).show();
    if (a.has("--count") && n < count) throw Failure("too few joint states");
  }

  static Object joint_state(Reader& r) {
    r.get<int32_t>();
    r.get<uint32_t>();
    r.text();
    auto number = [](Reader& r) { return r.get<double>(); };
    Object message;
    message.add("name", r.sequence<std::string>([](Reader& r) { return r.text(); }));
    message.add("position", r.sequence<double>(number));
    message.add("velocity", r.sequence<double>(number));
    return message.add("effort", r.sequence<double>(number));
  }

  // The next message from now on.
  void axis_states(const Arguments& a) {
    auto& s = subscription(a[1] + "/axis_states", "lineshaft_msgs::msg::dds_::AxisStates_");
    s.drain([](Reader&) {});
    Object seen;
    bool is_there = false;
    wait_until([&] {
      s.drain([&](Reader& r) { seen = states::axis_states(r), is_there = true; });
      return is_there;
    }, REPLY_S, "~/axis_states stopped");
    seen.show();
  }

  void events(const Arguments& a) {
    auto& s = subscription(a[1] + "/events", "lineshaft_msgs::msg::dds_::Event_");
    auto until = a.text("--until", "");
    bool found = false;
    auto start = Clock::now();
    do {
      s.drain([&](Reader& r) {
        states::Event event(r);
        Object().add("message", event.message.done()).show();
        found = found || event.kind == until;
      });
      sleep_ms(2);
    } while (!found && since(start) < a.number("--seconds", 0));
    if (a.has("--until") && !found) throw Failure("no event of kind " + until);
  }

  void clock_steps(const Arguments& a) {
    auto& enable = axes_service(a[1] + "/enable");
    states::ClockSteps steps(dds_, a[1], a[2], a.number("--ahead", 0), [&] {
      Writer w;
      enable.call(w.put<uint32_t>(1).text("no_such_axis").bytes());
    });
    for (auto& by : a.from(3)) steps.step(std::stod(by));
  }

  void axes(const Arguments& a) {
    Writer w;
    auto names = a.from(3);
    w.put<uint32_t>(names.size());
    for (auto& name : names) w.text(name);
    answered(axes_service(a[1] + "/" + a[2]), w, [&](Reader&, Object& seen) { seen.add("verb", a[2]); });
  }

  void move(const Arguments& a) {
    MoveGoal goal;
    goal.axis = a.text("--axis", "");
    goal.mode = a.choice("--mode", MODES);
    goal.units = a.choice("--units", UNITS);
    goal.position = a.number("--position", 0);
    goal.velocity = a.number("--velocity", 0);
    goal.buffer_mode = static_cast<uint8_t>(a.number("--buffer-mode", 0));
    auto& client = move_client(a[1]);
    auto id = client.send(goal);
    bool cancels = a.has("--cancel-after");
    if (cancels) {
      sleep_ms(static_cast<int>(1000 * a.number("--cancel-after", 0)));
      client.cancel(id);
    }
    if (cancels || a.has("--wait")) client.finish(id, a.text("--expect", cancels ? "CANCELED" : "SUCCEEDED"));
  }

  void probe(const Arguments& a) {
    const std::string name = a[1] + "/probe_axis", type = "lineshaft_msgs::action::dds_::ProbeAxis";
    auto& action = action_client(name, type);
    auto& feedback = subscription(name + "/_action/feedback", type + "_FeedbackMessage_");
    ProbeGoal goal;
    goal.axis = a.text("--axis", "");
    goal.event = a.text("--event", "");
    goal.edge = a.choice("--edge", EDGES);
    goal.position = a.number("--position", 0);
    goal.velocity = a.number("--velocity", 0);
    goal.distance = a.number("--distance", 0);
    auto id = action.send([&](Writer& w) { goal.put(w); });
    auto status = action.finish(id, [](Reader& r, Object& seen) {
      Object result;
      result.add("code", r.get<uint32_t>()).add("message", r.text()).add("probed", r.get<uint8_t>() != 0);
      result.add("probed_position", r.get<double>()).add("probed_increments", r.get<int64_t>());
      result.add("position", r.get<double>()).add("position_increments", r.get<int64_t>());
      seen.add("result", result.done());
    });
    sleep_ms(50);  // feedback is another topic: let what was sent before the result arrive
    std::set<int> phases;
    feedback.drain([&](Reader& r) {
      if (hex(r.take(16)) == hex(id.data())) phases.insert(r.get<uint8_t>());
    });
    Object().add("phases", std::vector<int>(phases.begin(), phases.end())).show();
    auto expected = a.text("--expect", "SUCCEEDED");
    if (status != expected) throw Failure("the goal ended " + status + ", not " + expected);
  }

  // Velocities for one joint, again and again.
  void stream(const Arguments& a) {
    if (a[2] != "jog") throw Failure("a stream of " + a[2] + " is unknown");
    auto name = a[1] + "/jog", axis = a.text("--axis", "");
    auto equals = axis.find('=');
    if (equals == std::string::npos) throw Failure("--axis NAME=VELOCITY is needed");
    Bytes message = joints::jog(axis.substr(0, equals), std::stod(axis.substr(equals + 1)));
    DataWriter* w = writer(name, "control_msgs::msg::dds_::JointJog_");
    wait_until([&] { return matched(w); }, MATCH_S, "nobody reads " + name);
    size_t sent = 0;
    for (auto start = Clock::now(); sent == 0 || since(start) < a.number("--seconds", 0); sent++) {
      w->write(&message);
      sleep_ms(static_cast<int>(1000 / a.number("--rate", 50)));
    }
    Object().add("sent", sent).show();
  }

  void vocabulary(const Arguments& a) {
    std::string arguments;
    for (auto& word : a.from(4)) arguments += (arguments.empty() ? "" : " ") + word;
    Writer w;
    w.text(a[2]).text(a[3]).text(arguments);
    answered(lineshaft_service(a[1], "vocabulary", "Vocabulary"), w, [](Reader&, Object&) {});
  }

  void params(const Arguments& a) {
    Writer w;
    auto words = a.from(3);
    auto call = [&](const std::string& name, const std::string& type) {
      return parameter_service(a[1] + "/" + name, type).call(w.bytes());
    };
    auto result = [](Reader& r) {
      bool successful = r.get<uint8_t>() != 0;
      return Object().add("successful", successful).add("reason", r.text()).done();
    };
    if (a[2] == "set" || a[2] == "set_atomically") {
      put_parameters(w, words);
      bool each = a[2] == "set";
      Bytes reply = each ? call("set_parameters", "SetParameters")
                         : call("set_parameters_atomically", "SetParametersAtomically");
      Reader r(reply);
      Object response;
      if (each) response.add("results", r.sequence<Json>(result));
      else response.add("result", result(r));
      Object().add(a[2], response.done()).show();
      return;
    }
    w.put<uint32_t>(words.size());
    for (auto& name : words) w.text(name);
    if (a[2] == "get") {
      Bytes reply = call("get_parameters", "GetParameters");
      Reader r(reply);
      Object().add("get", r.sequence<Json>(value)).show();
      return;
    }
    Bytes reply = call("describe_parameters", "DescribeParameters");
    Reader r(reply);
    auto count = r.get<uint32_t>();
    Object().add("count", count).show();
    for (; count > 0; count--) show_descriptor(r);
  }

  void function(const Arguments& a) {
    Writer w;
    w.text(a[2]).put<uint8_t>(order(a[3]));
    put_parameters(w, a.from(4));
    answered(lineshaft_service(a[1], "command_function", "CommandFunction"), w, [](Reader& r, Object& seen) {
      seen.add("active", parameters(r));
    });
  }

  static uint8_t order(const std::string& word) {
    const std::map<std::string, uint8_t> orders{{"reset", 0}, {"start", 1}, {"value_new", 5}, {"read_value", 6}};
    auto found = orders.find(word);
    return found == orders.end() ? std::stoi(word) : found->second;
  }

  void load_table(const Arguments& a) { load(a, integers(a.text("--x", "")), integers(a.text("--y", ""))); }

  void load(const Arguments& a, const std::vector<int64_t>& x, const std::vector<int64_t>& y) {
    Writer w;
    put_integers(put_integers(w.text(a[2]), x), y);
    answered(lineshaft_service(a[1], "load_table", "LoadTable"), w, [](Reader&, Object&) {});
  }

  // So many values that neither request nor answer fits a few datagrams.
  void load_long_table(const Arguments& a) {
    std::vector<int64_t> all;
    for (int k = 0; k < a.number("--count", 65536); k++) all.push_back(k % 65536);
    load(a, {}, all);
    Bytes reply = lineshaft_service(a[1], "get_table", "GetTable").call(Writer().text(a[2]).bytes());
    Reader r(reply);
    if (r.get<uint8_t>() == 0) throw Failure(r.text());
    r.text();
    r.text();
    auto integer = [](Reader& r) { return r.get<int64_t>(); };
    r.sequence<int64_t>(integer);
    if (r.sequence<int64_t>(integer) != all) throw Failure("other values came back");
    Object().add("count", all.size()).show();
  }

  void get_table(const Arguments& a) {
    Writer w;
    answered(lineshaft_service(a[1], "get_table", "GetTable"), w.text(a[2]), [](Reader& r, Object& seen) {
      auto integer = [](Reader& r) { return r.get<int64_t>(); };
      seen.add("form", r.text());
      seen.add("x", r.sequence<int64_t>(integer));
      seen.add("y", r.sequence<int64_t>(integer));
    });
  }

  // The next message from now on.
  void functions(const Arguments& a) {
    auto& s = subscription(a[1] + "/functions", "lineshaft_msgs::msg::dds_::FunctionStates_");
    s.drain([](Reader&) {});
    Object seen;
    bool is_there = false;
    wait_until([&] {
      s.drain([&](Reader& r) { seen = function_states(r), is_there = true; });
      return is_there;
    }, REPLY_S, "~/functions stopped");
    seen.show();
  }

  // Calls what answers with success and message, then with what `more` adds.
  template <class More>
  static void answered(Service& service, const Writer& request, More more) {
    Bytes reply = service.call(request.bytes());
    Reader r(reply);
    bool success = r.get<uint8_t>() != 0;
    auto message = r.text();
    Object seen;
    more(r, seen.add("success", success).add("message", message));
    seen.show();
    if (!success) throw Failure(message);
  }

  Service& lineshaft_service(const std::string& node, const std::string& name, const std::string& type) {
    auto full = node + "/" + name;
    return once(services_, full, [&] { return new Service(dds_, full, "lineshaft_msgs::srv::dds_::" + type); });
  }

  static void show_descriptor(Reader& r) {
    Object o;
    o.add("name", r.text());
    o.add("type", static_cast<int>(r.get<uint8_t>()));
    o.add("description", r.text());
    o.add("additional_constraints", r.text());
    o.add("read_only", r.get<uint8_t>() != 0);
    o.add("dynamic_typing", r.get<uint8_t>() != 0);
    for (auto n = r.get<uint32_t>(); n > 0; n--) {
      for (auto name : {"low", "high", "step"}) o.add(name, r.get<double>());
    }
    for (auto n = r.get<uint32_t>(); n > 0; n--) {
      for (auto name : {"low", "high", "step"}) o.add(name, r.get<int64_t>());
    }
    o.show();
  }

  Service& parameter_service(const std::string& name, const std::string& type) {
    return once(services_, name, [&] { return new Service(dds_, name, "rcl_interfaces::srv::dds_::" + type); });
  }

  void follow(const Arguments& a) {
    auto name = a[1] + "/follow_joint_trajectory";
    auto& action = action_client(name, "control_msgs::action::dds_::FollowJointTrajectory");
    auto start = a.has("--start") ? joints::from_now(a.number("--start", 0)) : Stamp{};
    auto id = action.send([&](Writer& w) { joints::put_follow_goal(w, joints::split(a[2], ','), a.from(3), start); });
    if (a.has("--leave")) {
      Object stamp;
      stamp.add("sec", start.sec).add("nanosec", start.nanosec);
      Object().add("goal", hex(id.data())).add("stamp", stamp.done()).show();
      return;
    }
    action.finish(id, [](Reader& r, Object& seen) {
      seen.add("error_code", r.get<int32_t>());
      seen.add("error_string", r.text());
    });
  }

  void gripper(const Arguments& a) {
    auto& action = action_client(a[1] + "/gripper_cmd", "control_msgs::action::dds_::GripperCommand");
    action.run([&](Writer& w) { w.put<double>(std::stod(a[2])).put<double>(0.0); },
               [](Reader& r, Object& seen) {
                 for (auto key : {"position", "effort"}) seen.add(key, r.get<double>());
                 for (auto key : {"stalled", "reached_goal"}) seen.add(key, r.get<uint8_t>() != 0);
               });
  }

  void controllers(const Arguments& a) {
    // A request without fields has one byte.
    Bytes reply = manager_service(a[1], "list_controllers", "ListControllers").call(Writer().put<uint8_t>(0).bytes());
    Reader r(reply);
    Object().add("controllers", r.sequence<Json>(joints::controller)).show();
  }

  void switch_controllers(const Arguments& a) {
    Writer w;
    bool activates = a[2] == "activate";
    joints::put_texts(w, activates ? a.from(3) : std::vector<std::string>());
    joints::put_texts(w, activates ? std::vector<std::string>() : a.from(3));
    w.put<int32_t>(2).put<uint8_t>(0);  // strict, not as soon as possible
    joints::put_duration(w, 0.0);
    answered(manager_service(a[1], "switch_controller", "SwitchController"), w, [](Reader&, Object&) {});
  }

  void query_state(const Arguments& a) {
    auto name = a[1] + "/query_state";
    auto& service = once(services_, name, [&] {
      return new Service(dds_, name, "control_msgs::srv::dds_::QueryTrajectoryState");
    });
    auto ns = std::stoll(a[2]);
    Writer w;
    w.put<int32_t>(static_cast<int32_t>(ns / 1000000000)).put<uint32_t>(static_cast<uint32_t>(ns % 1000000000));
    answered(service, w, [](Reader& r, Object& seen) {
      seen.add("name", r.sequence<std::string>([](Reader& r) { return r.text(); }));
      for (auto key : {"position", "velocity", "acceleration"})
        seen.add(key, r.sequence<double>([](Reader& r) { return r.get<double>(); }));
    });
  }

  void touch_probe(const Arguments& a) {
    Writer w;
    w.text(a[2]).text(a[3]).put<uint8_t>(0).put<uint8_t>(0).put<uint8_t>(0).put<uint8_t>(0);
    answered(lineshaft_service(a[1], "touch_probe", "TouchProbe"), w.put<double>(0.0).put<double>(0.0),
             [](Reader&, Object&) {});
  }

  void set_position(const Arguments& a) {
    auto name = a.has("--relative") ? "set_position_relative" : "set_position";
    Writer w;
    w.text(a[2]).put<double>(std::stod(a[3])).put<uint8_t>(0);
    answered(lineshaft_service(a[1], name, "SetPosition"), w, [](Reader&, Object&) {});
  }

  void result(const Arguments& a) { move_client(a[1]).finish(from_hex(a[3]), a.text("--expect", "SUCCEEDED")); }

  void cancel(const Arguments& a) { move_client(a[1]).cancel(from_hex(a[3])); }

  // Requests in the form of the other RMW, or of no RMW, from a Fast DDS writer: none may be answered with yes.
  void bad_requests(const Arguments& a) {
    auto& service = move_client(a[1]).goals;
    MoveGoal goal;
    goal.axis = a.text("--axis", "x");
    goal.mode = 1;
    goal.position = 0.01;
    size_t sent = 0;
    std::vector<std::string> accepted;
    auto deliver = [&](const std::string& name, const Bytes& bytes, bool identified = true) {
      service.send(bytes, identified);
      sent++;
      sleep_ms(20);
      for (auto& reply : service.collect())
        if (Reader(reply.second).get<uint8_t>()) accepted.push_back(name);
      service.collect().clear();
    };
    Bytes good = goal.request(random_goal());
    Bytes header = good;
    header.insert(header.begin() + 4, 16, 7);
    deliver("the header of the other RMW", header);
    deliver("the header of the other RMW and no identity", header, false);
    Bytes longer = good;
    longer.insert(longer.end(), 8, 0);
    deliver("8 bytes too many", longer);
    for (size_t n = 4; n + 4 < good.size(); n++) deliver("cut", Bytes(good.begin(), good.begin() + n));
    for (double value : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
      goal.position = value;
      deliver("a number that is not finite", goal.request(random_goal()));
    }
    sleep_ms(500);
    for (auto& reply : service.collect())
      if (Reader(reply.second).get<uint8_t>()) accepted.push_back("a late answer");
    Object().add("to", service.name()).add("sent", sent).add("accepted", accepted).show();
    if (!accepted.empty()) throw Failure("a bad request was accepted");
  }

  void action_conformance(const Arguments& a) { Conformance(dds_, a[1], a.text("--axis", "x")).run(); }

  void hammer(const Arguments& a) {
    Hammer(axes_service(a[1] + "/enable"), axes_service(a[1] + "/halt"),
           parameter_service(a[1] + "/get_parameters", "GetParameters"),
           parameter_service(a[1] + "/set_parameters", "SetParameters"), move_client(a[1]), a.text("--axis", "x"),
           static_cast<unsigned>(a.number("--seed", 1)))
        .run(a.number("--seconds", 10), a.number("--rate", 0));
  }

  void newcomer(const Arguments& a) {
    auto start = Clock::now();
    Dds fresh;
    Service service(fresh, a[1] + "/reset_errors", "lineshaft_msgs::srv::dds_::AxesCommand");
    double found = since(start);
    Writer w;
    w.put<uint32_t>(1);
    w.text(a.text("--axis", "x"));
    service.call(w.bytes());
    Object().add("found_s", found).add("answered_s", since(start)).show();
  }

  void visits(const Arguments& a) { wire::visits(a[1], a.text("--axis", "x"), static_cast<size_t>(a.number("--count", 10))); }

  void readers(const Arguments& a) {
    DataWriter* w = writer(a[1], a[2]);
    int count = std::stoi(a[3]);
    wait_until([&] { return readers_of(w) == count; }, MATCH_S,
               "a writer of " + a[1] + " does not have " + a[3] + " readers");
  }

  void samples(const Arguments& a) {
    auto& s = once(any_, a[1], [&] { return new Subscription(dds_, a[1], a[2], a.has("--latched")); });
    size_t n = 0;
    for (auto start = Clock::now(); since(start) < a.number("--seconds", 1.0); sleep_ms(1))
      s.drain([&](Reader&) { n++; });
    Object().add("samples", n).show();
  }

  Service& axes_service(const std::string& name) {
    return once(services_, name, [&] { return new Service(dds_, name, "lineshaft_msgs::srv::dds_::AxesCommand"); });
  }

  Service& manager_service(const std::string& manager, const std::string& name, const std::string& type) {
    auto full = manager + "/" + name;
    return once(services_, full, [&] { return new Service(dds_, full, "controller_manager_msgs::srv::dds_::" + type); });
  }

  DataWriter* writer(const std::string& topic, const std::string& type) {
    return once(writers_, topic, [&] { return new Writing{dds_.writer("rt" + topic, type)}; }).writer;
  }

  Subscription& subscription(const std::string& topic, const std::string& type) {
    return once(any_, topic, [&] { return new Subscription(dds_, topic, type); });
  }

  joints::Action& action_client(const std::string& name, const std::string& type) {
    return once(actions_, name, [&] { return new joints::Action(dds_, name, type); });
  }

  MoveClient& move_client(const std::string& node) {
    return once(moves_, node, [&] { return new MoveClient(dds_, node); });
  }

  template <class T>
  static T& once(std::map<std::string, std::unique_ptr<T>>& all, const std::string& key,
                 const std::function<T*()>& make) {
    auto found = all.find(key);
    if (found == all.end()) found = all.emplace(key, std::unique_ptr<T>(make())).first;
    return *found->second;
  }
  template <class T, class Make>
  static T& once(std::map<std::string, std::unique_ptr<T>>& all, const std::string& key, Make make) {
    return once(all, key, std::function<T*()>(make));
  }

  static const std::map<std::string, void (Peer::*)(const Arguments&)> COMMANDS;
  struct Writing {
    DataWriter* writer;
  };
  Dds dds_;
  std::map<std::string, std::unique_ptr<Subscription>> joints_, any_;
  std::map<std::string, std::unique_ptr<Writing>> writers_;
  std::map<std::string, std::unique_ptr<Service>> services_;
  std::map<std::string, std::unique_ptr<MoveClient>> moves_;
  std::map<std::string, std::unique_ptr<joints::Action>> actions_;
};

const std::map<std::string, void (Peer::*)(const Arguments&)> Peer::COMMANDS{
    {"axis-states", &Peer::axis_states}, {"events", &Peer::events}, {"clock-steps", &Peer::clock_steps},
    {"probe", &Peer::probe}, {"stream", &Peer::stream},
    {"joint-states", &Peer::joint_states}, {"axes", &Peer::axes},     {"move", &Peer::move},
    {"bad-requests", &Peer::bad_requests}, {"result", &Peer::result}, {"cancel", &Peer::cancel},
    {"vocabulary", &Peer::vocabulary}, {"params", &Peer::params}, {"function", &Peer::function},
    {"functions", &Peer::functions}, {"load-table", &Peer::load_table},
    {"load-long-table", &Peer::load_long_table}, {"get-table", &Peer::get_table},
    {"action-conformance", &Peer::action_conformance}, {"hammer", &Peer::hammer},
    {"follow", &Peer::follow}, {"gripper", &Peer::gripper},
    {"controllers", &Peer::controllers}, {"switch-controllers", &Peer::switch_controllers},
    {"query-state", &Peer::query_state},
    {"touch-probe", &Peer::touch_probe}, {"set-position", &Peer::set_position},
    {"newcomer", &Peer::newcomer}, {"visits", &Peer::visits},
    {"readers", &Peer::readers}, {"samples", &Peer::samples},
};

void serve(Peer& peer) {
  for (std::string line; std::getline(std::cin, line);) {
    Object done;
    done.add("done", line.substr(0, line.find(' ')));
    try {
      peer.run(line);
      done.add("ok", true);
    } catch (const std::exception& e) {
      done.add("ok", false).add("error", e.what());
    }
    done.show();
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::string line;
  for (int i = 1; i < argc; i++) line += (i > 1 ? " " : "") + std::string(argv[i]);
  if (line.empty() || line == "--help") {
    std::cout << USAGE;
    return line.empty() ? 2 : 0;
  }
  try {
    Peer peer;
    if (line == "serve") serve(peer);
    else peer.run(line);
  } catch (const std::exception& e) {
    Object().add("error", e.what()).show();
    return 1;
  }
  return 0;
}
