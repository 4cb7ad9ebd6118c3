// Values of parameters (rcl_interfaces), and the states of functions (lineshaft_msgs), on the wire and as JSON.
#pragma once

#include "fastdds_wire.hpp"

namespace values {

using namespace wire;

enum Type : uint8_t { NONE, BOOL, INTEGER, DOUBLE, STRING, BYTES, BOOLS, INTEGERS, DOUBLES, STRINGS };

/// All of a text as a number, or nothing of it.
template <class T, class Parse>
bool whole(const std::string& text, T& number, Parse parse) {
  char* end = nullptr;
  number = parse(text.c_str(), &end);
  return !text.empty() && *end == 0;
}

/// Whole numbers with commas between; none of an empty text.
inline std::vector<int64_t> integers(const std::string& text) {
  std::vector<int64_t> all;
  std::istringstream items(text);
  for (std::string item; std::getline(items, item, ',');) {
    int64_t number;
    if (!whole(item, number, [](auto p, auto end) { return std::strtoll(p, end, 10); }))
      throw Failure(item + " is no whole number");
    all.push_back(number);
  }
  return all;
}

inline Writer& put_integers(Writer& w, const std::vector<int64_t>& all) {
  w.put<uint32_t>(all.size());
  for (auto one : all) w.put<int64_t>(one);
  return w;
}

/// A ParameterValue as JSON reads: true, 3, 0.5, [1,2]; anything else is a string.
inline void put_value(Writer& w, const std::string& text) {
  Type type = STRING;
  int64_t integer = 0;
  double number = 0;
  std::vector<int64_t> list;
  if (text == "true" || text == "false") {
    type = BOOL;
  } else if (whole(text, integer, [](auto p, auto end) { return std::strtoll(p, end, 10); })) {
    type = INTEGER;
  } else if (whole(text, number, [](auto p, auto end) { return std::strtod(p, end); })) {
    type = DOUBLE;
  } else if (text.size() > 1 && text.front() == '[' && text.back() == ']') {
    type = INTEGERS;
    list = integers(text.substr(1, text.size() - 2));
  }
  w.put<uint8_t>(type).put<uint8_t>(text == "true").put<int64_t>(type == INTEGER ? integer : 0);
  w.put<double>(type == DOUBLE ? number : 0).text(type == STRING ? text : "");
  w.put<uint32_t>(0).put<uint32_t>(0);
  put_integers(w, list).put<uint32_t>(0).put<uint32_t>(0);
}

/// A sequence of Parameter from words NAME=VALUE.
inline void put_parameters(Writer& w, const std::vector<std::string>& words) {
  w.put<uint32_t>(words.size());
  for (auto& word : words) {
    auto equals = word.find('=');
    if (equals == std::string::npos) throw Failure("NAME=VALUE is needed, not " + word);
    put_value(w.text(word.substr(0, equals)), word.substr(equals + 1));
  }
}

/// A ParameterValue; null without one.
inline Json value(Reader& r) {
  auto type = r.get<uint8_t>();
  auto truth = json(r.get<uint8_t>() != 0);
  auto integer = json(r.get<int64_t>());
  auto number = json(r.get<double>());
  auto text = json(r.text());
  auto bytes = json(r.sequence<uint8_t>([](Reader& r) { return r.get<uint8_t>(); }));
  auto truths = json(r.sequence<uint8_t>([](Reader& r) { return r.get<uint8_t>(); }));
  auto integers = json(r.sequence<int64_t>([](Reader& r) { return r.get<int64_t>(); }));
  auto numbers = json(r.sequence<double>([](Reader& r) { return r.get<double>(); }));
  auto texts = json(r.sequence<std::string>([](Reader& r) { return r.text(); }));
  const std::string all[] = {"null", truth, integer, number, text, bytes, truths, integers, numbers, texts};
  if (type > STRINGS) throw Failure("a value of type " + json(type));
  return {all[type]};
}

/// A sequence of Parameter as one object.
inline Json parameters(Reader& r) {
  Object all;
  for (auto n = r.get<uint32_t>(); n > 0; n--) {
    auto name = r.text();
    all.add(name, value(r));
  }
  return all.done();
}

/// A FunctionStates message.
inline Object function_states(Reader& r) {
  r.get<int32_t>();
  r.get<uint32_t>();
  r.text();
  Object message, functions;
  message.add("cycle", r.get<uint64_t>());
  std::vector<std::string> order;
  for (auto n = r.get<uint32_t>(); n > 0; n--) {
    Object state;
    order.push_back(r.text());
    state.add("name", order.back()).add("type", r.text());
    state.add("slot", r.get<uint16_t>()).add("active", r.get<uint8_t>() != 0);
    state.add("error_code", r.get<uint32_t>()).add("sink", r.get<int64_t>());
    state.add("inputs", r.get<uint8_t>()).add("outputs", r.get<uint8_t>());
    functions.add(order.back(), state.add("sak_share", r.get<int64_t>()).done());
  }
  return message.add("functions", functions.done()).add("order", order);
}

}  // namespace values
