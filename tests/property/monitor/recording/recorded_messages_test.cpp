// Tests that every message with any values in its fields is unchanged after a recording.

#include "monitor/recording/recorded_messages.h"

#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor.pb.h>
#include <google/protobuf/dynamic_message.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "messages/validation.h"

namespace coppice {
namespace {

double a_number(bool also_nan) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const auto odd =
      rc::gen::element(0.0, -0.0, 1.0, 0.1, -1e-310, infinity, -infinity, std::numeric_limits<double>::max());
  const double number = *rc::gen::oneOf(odd, rc::gen::arbitrary<double>());
  return also_nan && *rc::gen::inRange(0, 8) == 0 ? std::numeric_limits<double>::quiet_NaN() : number;
}

/// Any values; NaN only in fields that are not compared as numbers.
struct Any {
  bool also_nan = false;

  double number() const { return a_number(also_nan); }
  Point2 point() const {
    const double x = number();
    return {x, number()};
  }
  std::uint32_t u32() const {
    return *rc::gen::oneOf(rc::gen::element(0u, 1u, ~0u), rc::gen::arbitrary<std::uint32_t>());
  }
  std::uint64_t u64() const {
    return *rc::gen::oneOf(rc::gen::element(std::uint64_t{0}, ~std::uint64_t{0}),
                           rc::gen::arbitrary<std::uint64_t>());
  }
  std::uint8_t u8() const { return *rc::gen::arbitrary<std::uint8_t>(); }
  std::int32_t i32() const { return *rc::gen::arbitrary<std::int32_t>(); }
  bool flag() const { return *rc::gen::arbitrary<bool>(); }
  std::string name() const {
    return *rc::gen::element<std::string>("", "r1", "größer", "\xF0\x9F\x90\x99", std::string(64, 'x'),
                                          std::string("a\0b", 3));
  }
  /// Any value, also one without a name.
  template <class E>
  E one() const {
    return static_cast<E>(u8());
  }
  template <class Make>
  auto some(Make make) const {
    std::vector<decltype(make())> all;
    for (int k = *rc::gen::inRange(0, 4); k > 0; --k) all.push_back(make());
    return all;
  }
  Path path() const {
    Path all;
    for (int k = *rc::gen::inRange(0, 4); k > 0; --k) all.push_back(point());
    return all;
  }
  Trajectory trajectory() const {
    return some([&] { return TimedPoint{number(), point()}; });
  }
  std::vector<ReservationBasis> basis() const {
    return some([&] { return ReservationBasis{name(), u32(), number()}; });
  }
  RoundId round() const { return {u32(), name(), point(), number()}; }
  TreeParameters trees() const {
    return {number(), u32(), number(), number(), number(), number(), one<Restarts>()};
  }
};

template <class M>
M any(const Any& a);
template <>
MapMessage any(const Any& a) {
  MapMessage m{a.name(), {}, a.some([&] { return a.number(); }), a.trees()};
  m.map.width = *rc::gen::inRange(0, 12);
  m.map.height = *rc::gen::inRange(0, 12);
  m.map.resolution = a.number();
  m.map.origin = a.point();
  m.map.y_axis = a.flag() ? YAxis::up : YAxis::down;
  for (int k = 0; k < m.map.width * m.map.height; ++k) m.map.blocked.push_back(a.flag());
  return m;
}
template <>
Mission any(const Any& a) {
  return {a.name(),   a.u32(),    a.u32(),    a.name(),
          a.point(),  a.point(),  a.number(), a.number(),
          a.number(), a.number(), a.u64(),    a.one<PlannerKind>(),
          a.trees(),  a.number(), a.flag(),   {a.number(), a.number()}};
}
template <>
RootNodes any(const Any& a) {
  return {a.name(), a.u32(), a.u32(), a.some([&] {
            return RootNodes::Node{a.one<Root>(), a.point(), a.i32()};
          })};
}
template <>
InactiveTreesMessage any(const Any& a) {
  return {{a.u64(), a.u32()},
          a.name(),
          a.number(),
          a.some([&] {
            return InactiveTreesMessage::Node{a.point(), a.i32(), a.number()};
          }),
          a.some([&] {
            return InactiveTreesMessage::Link{a.u32(), {a.u64(), a.u32()}, a.u32()};
          })};
}
template <>
RobotState any(const Any& a) {
  return {a.name(),
          a.u32(),
          {a.number(), a.point(), a.point(), a.number(), a.point(), a.number()},
          a.number(),
          a.number(),
          a.number(),
          a.one<Phase>(),
          a.round(),
          a.one<Stage>(),
          a.u32(),
          a.number(),
          a.name(),
          a.u8(),
          a.u8(),
          a.flag(),
          a.flag(),
          a.flag(),
          a.flag(),
          a.flag(),
          a.some([&] { return a.name(); }),
          a.some([&] {
            return Echo{a.name(), a.number(), a.number()};
          }),
          a.some([&] {
            return ReservationId{a.name(), a.u32()};
          })};
}
template <>
JointPlanMessage any(const Any& a) {
  return {a.round(), a.some([&] {
            return JointPlanMessage::Member{a.name(), a.number(), a.flag(), a.trajectory()};
          }),
          a.basis()};
}
template <>
ReservationMessage any(const Any& a) {
  return {a.name(),
          a.u32(),
          a.u32(),
          a.number(),
          a.number(),
          a.trajectory(),
          a.basis(),
          {a.name(), a.u32(), a.number()},
          static_cast<Priority>(a.u32() % 4)};
}
template <>
PathMessage any(const Any& a) {
  return {a.name(), a.u32(), a.path()};
}
template <>
TrackMessage any(const Any& a) {
  return {a.name(), a.u32(), a.u32(), a.some([&] {
            return TrackMessage::Point{a.number(), a.point(), a.point()};
          })};
}
template <>
AgentStatus any(const Any& a) {
  return {a.name(),
          a.u32(),
          a.one<Phase>(),
          a.name(),
          a.number(),
          a.number(),
          a.number(),
          a.number(),
          a.number(),
          a.number(),
          a.u32(),
          a.u32(),
          a.u32(),
          a.u32(),
          a.u32(),
          a.u32(),
          {a.u32(), a.u32(), a.u32(), a.u32(), a.u32(), a.number(), a.u64(), a.u64(), a.number(), a.number(),
           a.number(), a.number()},
          a.number(),
          a.number(),
          a.name(),
          a.number(),
          a.number()};
}
template <>
ServiceStatus any(const Any& a) {
  return {a.u64(), a.name(), a.u32(), a.number(), a.number()};
}
template <>
BrokerStatus any(const Any& a) {
  return {a.u64(), a.flag(), a.number(), a.u32(), a.u32(), a.u32(), a.u32(), a.name(), a.u32(), a.number()};
}
template <>
Claim any(const Any& a) {
  return {a.u64(), a.u32(), a.name()};
}
template <>
Assignment any(const Any& a) {
  return {a.name(), a.u64(), a.u32()};
}

template <>
ActiveTreesMessage any(const Any& a) {
  return {a.u64(), a.name(), a.some([&] { return ActiveTreesMessage::Edge{a.point(), a.point()}; })};
}

template <>
OrderMessage any(const Any& a) {
  return {a.name(),
          a.one<Action>(),
          a.some([&] { return a.name(); }),
          a.some([&] {
            return Visit{a.point(), a.flag(), a.number(), a.number()};
          }),
          a.name(),
          a.i32(),
          a.number(),
          a.name()};
}
template <>
OrderStatus any(const Any& a) {
  return {any<OrderMessage>(a), a.one<OrderState>(), a.name(),  a.name(), a.u32(), a.u32(),
          a.number(),           a.number(),          a.number()};
}
template <>
HaltMessage any(const Any& a) {
  return {a.u64(), a.one<Halt>(), a.some([&] { return HaltMessage::Robot{a.name(), a.one<Halt>()}; })};
}

template <class M>
void expect_same_after_recording() {
  const Message message = any<M>({});
  const auto back = message_in(message.index(), recorded(message));
  RC_ASSERT(back.has_value());
  RC_ASSERT(*back == message);
  // Messages with NaN are compared as bytes. The check above shows that the bytes hold everything.
  const Message odd = any<M>({.also_nan = true});
  RC_ASSERT(recorded(message_in(odd.index(), recorded(odd)).value()) == recorded(odd));
}

template <class M>
class RecordedMessages : public testing::Test {};
template <class V>
struct TypesOf;
template <class... Ms>
struct TypesOf<std::variant<Ms...>> {
  using Type = testing::Types<Ms...>;
};
TYPED_TEST_SUITE(RecordedMessages, TypesOf<Message>::Type);

TYPED_TEST(RecordedMessages, MessagesAreUnchangedAfterARecording) {
  EXPECT_TRUE(rc::check(expect_same_after_recording<TypeParam>));
}

TYPED_TEST(RecordedMessages, AnyBytesAreReadAsAMessageOrRefused) {
  EXPECT_TRUE(rc::check([](const std::string& bytes) {
    const auto message = message_in(topic_number<TypeParam>(), bytes);
    const bool is_of_its_type = !message || std::holds_alternative<TypeParam>(*message);
    RC_ASSERT(is_of_its_type);  // it would evaluate both sides of the condition
  }));
}

/// The schema in the file suffices to read the messages.
TYPED_TEST(RecordedMessages, TheSchemaDescribesTheMessages) {
  const TopicNumber topic = topic_number<TypeParam>();
  google::protobuf::FileDescriptorSet files;
  ASSERT_TRUE(files.ParseFromString(recorded_schema()));
  google::protobuf::DescriptorPool pool;
  for (const auto& file : files.file()) ASSERT_NE(pool.BuildFile(file), nullptr);
  const auto* const described = pool.FindMessageTypeByName(schema_name(topic));
  ASSERT_NE(described, nullptr);
  google::protobuf::DynamicMessageFactory factory;
  EXPECT_TRUE(rc::check([&] {
    const std::string bytes = recorded(any<TypeParam>({}));
    const std::unique_ptr<google::protobuf::Message> message(factory.GetPrototype(described)->New());
    RC_ASSERT(message->ParseFromString(bytes));
    RC_ASSERT(message->SerializeAsString() == bytes);
  }));
}

TEST(RecordedMessage, AMessageThatIsTooLongIsRefused) {
  const std::string long_one(largest_recorded(topic_number<Claim>()) + 1, '\0');
  EXPECT_FALSE(message_in(topic_number<Claim>(), long_one));
  EXPECT_TRUE(problem_with(message_in(topic_number<Claim>(), "\x1a\x01\xff").value())) << "no UTF-8";
}

TEST(RecordedMessage, MalformedBytesAreRefused) {
  const TopicNumber path = topic_number<PathMessage>();
  EXPECT_TRUE(message_in(path, "")) << "all fields are left out";
  EXPECT_TRUE(message_in(path, std::string("\xf8\x07\x01", 3))) << "field 127 is of a later version";
  EXPECT_FALSE(message_in(path, std::string("\x00", 1))) << "no field has the number 0";
  EXPECT_FALSE(message_in(path, "\x0a\x05one")) << "the robot's name is cut off";
  EXPECT_FALSE(message_in(path, "\x1a\x09\x09")) << "a waypoint is cut off";
  EXPECT_FALSE(message_in(path, "\x1a\x02\x09\x01")) << "a number is longer than its waypoint";
  EXPECT_FALSE(message_in(path, "\x0b")) << "groups are not used";
  const auto plan = topic_number<JointPlanMessage>();
  EXPECT_FALSE(message_in(plan, std::string("\x12\x03\x0a\x04\x00", 5)))
      << "a name is longer than its member";
}

TEST(RecordedMessage, FieldsAreReadInAnyOrder) {
  const auto message = message_in(topic_number<Assignment>(), "\x18\x03\x10\x02\x0a\x01r");
  ASSERT_TRUE(message);
  EXPECT_EQ(std::get<Assignment>(*message), (Assignment{"r", 2, 3}));
}

}  // namespace
}  // namespace coppice
