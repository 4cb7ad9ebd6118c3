// ROS 2 on the wire with Fast DDS 2: CDR, JSON lines, topics, and services as rmw_fastrtps_cpp speaks them.
//
// A request carries the GUID of its client's reply reader in the inline QoS (related_sample_identity), a reply carries
// that GUID and the number of the request; payloads have no header.
#pragma once

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <functional>
#include <iostream>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace wire {

using namespace eprosima::fastdds::dds;
using namespace eprosima::fastrtps::rtps;

// Generous, because the tests share two cores with a compiler.
constexpr double MATCH_S = 20.0;
constexpr double REPLY_S = 10.0;
constexpr double RESULT_S = 60.0;

using Clock = std::chrono::steady_clock;
using Bytes = std::vector<uint8_t>;  // CDR, little endian, with the four bytes of encapsulation

inline double since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

inline void sleep_ms(int ms) { std::this_thread::sleep_for(std::chrono::milliseconds(ms)); }

struct Failure : std::runtime_error {
  using std::runtime_error::runtime_error;
};

inline void wait_until(const std::function<bool()>& condition, double timeout, const std::string& complaint) {
  for (auto start = Clock::now(); !condition(); sleep_ms(1))
    if (since(start) > timeout) throw Failure(complaint);
}

// ---- CDR

class Writer {
 public:
  template <class T>
  Writer& put(T value) {
    while ((bytes_.size() - 4) % sizeof(T)) bytes_.push_back(0);
    auto p = reinterpret_cast<const uint8_t*>(&value);
    bytes_.insert(bytes_.end(), p, p + sizeof(T));
    return *this;
  }
  Writer& text(const std::string& s) {
    put<uint32_t>(s.size() + 1);
    bytes_.insert(bytes_.end(), s.begin(), s.end());
    bytes_.push_back(0);
    return *this;
  }
  Writer& raw(const uint8_t* p, size_t n) {
    bytes_.insert(bytes_.end(), p, p + n);
    return *this;
  }
  const Bytes& bytes() const { return bytes_; }

 private:
  Bytes bytes_{0, 1, 0, 0};
};

class Reader {
 public:
  explicit Reader(const Bytes& bytes) : bytes_(bytes) {}
  template <class T>
  T get() {
    while ((at_ - 4) % sizeof(T)) at_++;
    T value;
    std::memcpy(&value, take(sizeof(T)), sizeof(T));
    return value;
  }
  std::string text() {
    auto n = get<uint32_t>();
    if (n == 0) throw Failure("a string without its NUL");
    auto p = reinterpret_cast<const char*>(take(n));
    return std::string(p, n - 1);
  }
  template <class T>
  std::vector<T> sequence(const std::function<T(Reader&)>& one) {
    std::vector<T> all;
    for (auto n = get<uint32_t>(); n > 0; n--) all.push_back(one(*this));
    return all;
  }
  const uint8_t* take(size_t n) {
    if (n > bytes_.size() - std::min(at_, bytes_.size())) throw Failure("a message ends too early");
    auto p = bytes_.data() + at_;
    at_ += n;
    return p;
  }

 private:
  const Bytes& bytes_;
  size_t at_ = 4;
};

// ---- JSON

inline std::string json(const std::string& s) {
  std::string out = "\"";
  for (unsigned char c : s) {
    if (c == '"' || c == '\\') (out += '\\') += c;
    else if (c >= 0x20) out += c;
    else out += ' ';
  }
  return out + "\"";
}
inline std::string json(const char* s) { return json(std::string(s)); }
inline std::string json(bool b) { return b ? "true" : "false"; }
template <class T>
std::string json(T number) {
  std::ostringstream out;
  out.precision(17);
  out << +number;
  return std::isfinite(static_cast<double>(number)) ? out.str() : json(out.str());
}
template <class T>
std::string json(const std::vector<T>& all) {
  std::string out = "[";
  for (const T& one : all) out += (out.size() > 1 ? ", " : "") + json(one);
  return out + "]";
}
/// A finished piece of JSON.
struct Json {
  std::string text;
};
inline std::string json(const Json& j) { return j.text; }

class Object {
 public:
  template <class T>
  Object& add(const std::string& name, const T& value) {
    text_ += (text_.empty() ? "" : ", ") + json(name) + ": " + json(value);
    return *this;
  }
  Json done() const { return {"{" + text_ + "}"}; }
  void show() const { std::cout << done().text << std::endl; }

 private:
  std::string text_;
};

// ---- DDS

struct RawType : TopicDataType {
  explicit RawType(const std::string& name) {
    setName(name.c_str());
    m_typeSize = 65000;
    m_isGetKeyDefined = false;
    auto_fill_type_information(false);
    auto_fill_type_object(false);
  }
  bool serialize(void* data, SerializedPayload_t* out) override {
    auto bytes = static_cast<Bytes*>(data);
    std::memcpy(out->data, bytes->data(), bytes->size());
    out->length = bytes->size();
    out->encapsulation = CDR_LE;
    return true;
  }
  bool deserialize(SerializedPayload_t* in, void* data) override {
    if (in->length < 4) return false;  // no encapsulation
    static_cast<Bytes*>(data)->assign(in->data, in->data + in->length);
    return true;
  }
  std::function<uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return static_cast<uint32_t>(static_cast<Bytes*>(data)->size()); };
  }
  void* createData() override { return new Bytes; }
  void deleteData(void* data) override { delete static_cast<Bytes*>(data); }
  bool getKey(void*, InstanceHandle_t*, bool) override { return false; }
};

/// One participant, on loopback unless ROS_AUTOMATIC_DISCOVERY_RANGE is SUBNET; endpoints live as long as it.
class Dds {
 public:
  Dds() {
    const char* id = std::getenv("ROS_DOMAIN_ID");
    int domain = id ? std::atoi(id) : 0;
    const char* range = std::getenv("ROS_AUTOMATIC_DISCOVERY_RANGE");
    DomainParticipantQos q;
    if (!range || std::string(range) != "SUBNET") keep_to_loopback(q, domain);
    participant_ = DomainParticipantFactory::get_instance()->create_participant(domain, q);
    if (!participant_) throw Failure("no DDS participant could be made in domain " + std::to_string(domain));
    publisher_ = participant_->create_publisher(PUBLISHER_QOS_DEFAULT);
    subscriber_ = participant_->create_subscriber(SUBSCRIBER_QOS_DEFAULT);
  }
  // Says goodbye, so that nobody waits for this participant's lease to end.
  ~Dds() {
    participant_->delete_contained_entities();
    DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  Dds(const Dds&) = delete;
  Dds& operator=(const Dds&) = delete;
  DataWriter* writer(const std::string& name, const std::string& type) {
    DataWriterQos q;
    settle(q);
    q.history().depth = 10;
    return made(publisher_->create_datawriter(topic(name, type), q), name);
  }
  DataReader* reader(const std::string& name, const std::string& type, bool latched = false) {
    DataReaderQos q;
    settle(q);
    q.history().depth = latched ? 1 : 1000;
    if (latched) q.durability().kind = TRANSIENT_LOCAL_DURABILITY_QOS;
    return made(subscriber_->create_datareader(topic(name, type), q), name);
  }

 private:
  static void keep_to_loopback(DomainParticipantQos& q, int domain) {
    q.transport().use_builtin_transports = false;
    auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    udp->interfaceWhiteList.push_back("127.0.0.1");
    q.transport().user_transports.push_back(udp);
    for (int i = 0; i < 30; i++) {  // discovery ports of the first participants of this domain
      Locator_t l;
      IPLocator::setIPv4(l, "127.0.0.1");
      l.port = 7400 + 250 * domain + 10 + 2 * i;
      q.wire_protocol().builtin.initialPeersList.push_back(l);
    }
  }
  template <class Q>
  static void settle(Q& q) {
    q.reliability().kind = RELIABLE_RELIABILITY_QOS;
    q.durability().kind = VOLATILE_DURABILITY_QOS;
    q.endpoint().history_memory_policy = PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
    q.data_sharing().off();
  }
  template <class T>
  static T* made(T* endpoint, const std::string& name) {
    if (!endpoint) throw Failure("no endpoint could be made for " + name);
    return endpoint;
  }
  Topic* topic(const std::string& name, const std::string& type) {
    Topic*& t = topics_[name];
    if (!t) {
      TypeSupport(new RawType(type)).register_type(participant_);
      t = participant_->create_topic(name, type, TOPIC_QOS_DEFAULT);
    }
    return t;
  }
  DomainParticipant* participant_;
  Publisher* publisher_;
  Subscriber* subscriber_;
  std::map<std::string, Topic*> topics_;
};

inline bool matched(DataReader* r) {
  SubscriptionMatchedStatus s;
  r->get_subscription_matched_status(s);
  return s.current_count > 0;
}

inline int readers_of(DataWriter* w) {
  PublicationMatchedStatus s;
  w->get_publication_matched_status(s);
  return s.current_count;
}

inline bool matched(DataWriter* w) { return readers_of(w) > 0; }

class Subscription {
 public:
  Subscription(Dds& dds, const std::string& name, const std::string& type, bool latched = false)
      : reader_(dds.reader("rt" + name, type, latched)) {
    wait_until([&] { return matched(reader_); }, MATCH_S, "nobody publishes " + name);
  }
  void drain(const std::function<void(Reader&)>& each) {
    Bytes bytes;
    SampleInfo info;
    while (reader_->take_next_sample(&bytes, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data) continue;
      Reader r(bytes);
      each(r);
    }
  }

 private:
  DataReader* reader_;
};

class Service {
 public:
  /// `type` without _Request_ and _Response_.
  Service(Dds& dds, const std::string& name, const std::string& type)
      : name_(name),
        writer_(dds.writer("rq" + name + "Request", type + "_Request_")),
        reader_(dds.reader("rr" + name + "Reply", type + "_Response_")) {
    wait_until([&] { return matched(writer_) && matched(reader_); }, MATCH_S, "nobody serves " + name);
  }
  Bytes call(const Bytes& request, double timeout = REPLY_S) {
    auto number = send(request);
    wait_until([&] { return collect(), replies_.count(number) > 0; }, timeout, "no reply from " + name_);
    Bytes reply = replies_[number];
    replies_.erase(number);
    return reply;
  }
  /// With `identified` false the request lacks related_sample_identity, as another RMW's would.
  SequenceNumber_t send(const Bytes& request, bool identified = true) {
    WriteParams params;
    if (identified) params.related_sample_identity().writer_guid() = reader_->guid();
    Bytes copy = request;
    if (!writer_->write(&copy, params)) throw Failure("the request to " + name_ + " could not be written");
    return params.sample_identity().sequence_number();
  }
  /// The replies to this client that no call has taken yet.
  std::map<SequenceNumber_t, Bytes>& collect() {
    Bytes bytes;
    SampleInfo info;
    while (reader_->take_next_sample(&bytes, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data) continue;
      const auto& id = info.related_sample_identity;
      if (id.writer_guid() != reader_->guid() && id.writer_guid() != writer_->guid()) continue;
      if (!answered_.insert(id.sequence_number()).second) twice_++;
      replies_[id.sequence_number()] = bytes;
    }
    return replies_;
  }
  const std::string& name() const { return name_; }
  /// Replies to requests that had been answered.
  size_t twice() const { return twice_; }

 private:
  std::string name_;
  DataWriter* writer_;
  DataReader* reader_;
  std::set<SequenceNumber_t> answered_;
  size_t twice_ = 0;
  std::map<SequenceNumber_t, Bytes> replies_;
};

}  // namespace wire
