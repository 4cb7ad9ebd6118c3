// A ROS 2 peer on Fast DDS 2 for the end-to-end tests: one JSON line per observation, exit 1 on failure.
//
// The messages are written and read here byte by byte, from docs/contract.md, section 7.
#include "fastdds_load.hpp"
#include "fastdds_move.hpp"

using namespace motion;

namespace {

const char* const USAGE =
    "usage: fastdds_peer COMMAND [ARGUMENT..], the domain from ROS_DOMAIN_ID\n"
    "  joint-states [--seconds 3] [--count N]\n"
    "  axes NODE enable|disable|halt|quick_stop|reset_errors [AXIS..]\n"
    "  move NODE --axis A [--mode absolute] [--units si] [--position P] [--velocity V] [--buffer-mode N]\n"
    "       [--cancel-after S] [--wait]\n"
    "  vocabulary NODE AXIS VERB [ARGUMENTS..]\n"
    "  params NODE get|describe NAME..\n"
    "  params NODE set NAME=NUMBER\n"
    "  function NODE NAME COMMAND [FIELD=NUMBER..]\n"
    "  result NODE move_axis GOAL [--expect SUCCEEDED]\n"
    "  cancel NODE move_axis GOAL\n"
    "  bad-requests NODE [--axis x]\n"
    "  action-conformance NODE [--axis x]\n"
    "  newcomer NODE [--axis x]    a participant of its own: how long until the node has answered it\n"
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
      else if (word == "--wait") named_[word];
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

  void axes(const Arguments& a) {
    Writer w;
    auto names = a.from(3);
    w.put<uint32_t>(names.size());
    for (auto& name : names) w.text(name);
    Bytes reply = axes_service(a[1] + "/" + a[2]).call(w.bytes());
    Reader r(reply);
    bool success = r.get<uint8_t>() != 0;
    auto message = r.text();
    Object().add("verb", a[2]).add("success", success).add("message", message).show();
    if (!success) throw Failure(message);
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

  void vocabulary(const Arguments& a) {
    auto& service = once(services_, a[1] + "/vocabulary", [&] {
      return new Service(dds_, a[1] + "/vocabulary", "lineshaft_msgs::srv::dds_::Vocabulary");
    });
    std::string arguments;
    for (auto& word : a.from(4)) arguments += (arguments.empty() ? "" : " ") + word;
    Bytes reply = service.call(Writer().text(a[2]).text(a[3]).text(arguments).bytes());
    Reader r(reply);
    bool success = r.get<uint8_t>() != 0;
    auto message = r.text();
    Object().add("success", success).add("message", message).show();
    if (!success) throw Failure(message);
  }

  void params(const Arguments& a) {
    Writer w;
    auto names = a.from(3);
    w.put<uint32_t>(names.size());
    if (a[2] == "set") {
      for (auto& word : names) {
        auto equals = word.find('=');
        if (equals == std::string::npos) throw Failure("NAME=NUMBER is needed, not " + word);
        put_double(w.text(word.substr(0, equals)), std::stod(word.substr(equals + 1)));
      }
      Bytes reply = parameter_service(a[1] + "/set_parameters", "SetParameters").call(w.bytes());
      Reader r(reply);
      for (auto n = r.get<uint32_t>(); n > 0; n--) {
        bool successful = r.get<uint8_t>() != 0;
        Object().add("successful", successful).add("reason", r.text()).show();
      }
      return;
    }
    for (auto& name : names) w.text(name);
    bool gets = a[2] == "get";
    auto& service = gets ? parameter_service(a[1] + "/get_parameters", "GetParameters")
                         : parameter_service(a[1] + "/describe_parameters", "DescribeParameters");
    Bytes reply = service.call(w.bytes());
    Reader r(reply);
    auto count = r.get<uint32_t>();
    Object().add("count", count).show();
    for (; count > 0; count--) gets ? show_value(r) : show_descriptor(r);
  }

  // Values are sent as doubles, which a function takes where they are whole.
  void function(const Arguments& a) {
    Writer w;
    w.text(a[2]).put<uint8_t>(std::stoi(a[3]));
    auto values = a.from(4);
    w.put<uint32_t>(values.size());
    for (auto& word : values) {
      auto equals = word.find('=');
      if (equals == std::string::npos) throw Failure("FIELD=NUMBER is needed, not " + word);
      put_double(w.text(word.substr(0, equals)), std::stod(word.substr(equals + 1)));
    }
    auto& service = once(services_, a[1] + "/command_function", [&] {
      return new Service(dds_, a[1] + "/command_function", "lineshaft_msgs::srv::dds_::CommandFunction");
    });
    Bytes reply = service.call(w.bytes());
    Reader r(reply);
    bool success = r.get<uint8_t>() != 0;
    auto message = r.text();
    Object().add("success", success).add("message", message).show();
    for (auto n = r.get<uint32_t>(); n > 0; n--) {
      Object().add("name", r.text()).show();
      show_value(r);
    }
    if (!success) throw Failure(message);
  }

  static void put_double(Writer& w, double value) {
    w.put<uint8_t>(3).put<uint8_t>(0).put<int64_t>(0).put<double>(value).text("");
    for (int arrays = 0; arrays < 5; arrays++) w.put<uint32_t>(0);
  }

  static void show_value(Reader& r) {
    int type = r.get<uint8_t>();
    bool truth = r.get<uint8_t>() != 0;
    auto integer = r.get<int64_t>();
    auto number = r.get<double>();
    auto text = r.text();
    for (int arrays = 0; arrays < 5; arrays++)
      if (r.get<uint32_t>() > 0) throw Failure("a value with an array in it");
    Object o;
    o.add("type", type);
    if (type == 1) o.add("value", truth);
    if (type == 2) o.add("value", integer);
    if (type == 3) o.add("value", number);
    if (type == 4) o.add("value", text);
    o.show();
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

  void readers(const Arguments& a) {
    DataWriter* w = once(writers_, a[1], [&] { return new Writing{dds_.writer("rt" + a[1], a[2])}; }).writer;
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
};

const std::map<std::string, void (Peer::*)(const Arguments&)> Peer::COMMANDS{
    {"joint-states", &Peer::joint_states}, {"axes", &Peer::axes},     {"move", &Peer::move},
    {"bad-requests", &Peer::bad_requests}, {"result", &Peer::result}, {"cancel", &Peer::cancel},
    {"vocabulary", &Peer::vocabulary}, {"params", &Peer::params}, {"function", &Peer::function},
    {"action-conformance", &Peer::action_conformance}, {"hammer", &Peer::hammer},
    {"newcomer", &Peer::newcomer},
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
