// Tests of the choice of a DDS domain for a run.
#include "coppice/run/unused_domain.h"

#include <cstdint>

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "dds/discovery.h"

namespace coppice {
namespace {

TEST(UnusedDomain, TwoRunsThatSearchFromTheSameDomainGetDifferentDomains) {
  const UnusedDomain first("run");
  const UnusedDomain second("run");
  EXPECT_NE(first.number(), second.number());
  EXPECT_GE(second.number(), 1);
  EXPECT_LE(second.number(), 100);
}

TEST(UnusedDomain, ADomainIsFreeAgainWhenItsRunHasEnded) {
  int number = 0;
  {
    const UnusedDomain first("run");
    number = first.number();
  }
  EXPECT_EQ(UnusedDomain("run").number(), number);
}

TEST(UnusedDomain, ADomainThatAProcessHasJoinedIsLeftOut) {
  const int number = UnusedDomain("run").number();
  const int participant = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  ASSERT_GE(participant, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(domain_port(number)));
  ASSERT_EQ(bind(participant, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  EXPECT_NE(UnusedDomain("run").number(), number);
  close(participant);
}

}  // namespace
}  // namespace coppice
