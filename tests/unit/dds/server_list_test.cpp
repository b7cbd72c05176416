#include "dds/server_list.h"

#include <gtest/gtest.h>

namespace coppice {
namespace {

using Texts = std::vector<std::string>;

/// No resolver looks up a name whose label is that long.
std::string nobody() {
  return std::string(64, 'x') + ".net";
}

/// The third byte of a server's identity is its place in the list.
std::vector<int> places(const ServerList& list) {
  std::vector<int> all;
  for (const auto& server : list.found) all.push_back(server.guidPrefix.value[2]);
  return all;
}

TEST(ServerList, EachServerHasItsPlace) {
  const ServerList list = look_up_servers("10.0.0.1:11811;;10.0.0.2;");
  EXPECT_EQ(list.found.size(), 2u);
  EXPECT_EQ(list.unknown, Texts());
  EXPECT_EQ(list.malformed, Texts());
  ASSERT_EQ(places(list).size(), 2u);
  EXPECT_EQ(places(list)[0] + 2, places(list)[1]);
}

// A container that does not run has no name.
TEST(ServerList, AServerWithoutAnAddressLeavesThePlacesOfTheOthers) {
  const ServerList list = look_up_servers(nobody() + ":11811;10.0.0.2:11811");
  EXPECT_EQ(list.unknown, Texts{nobody() + ":11811"});
  EXPECT_EQ(list.malformed, Texts());
  EXPECT_EQ(places(list), places(look_up_servers(";10.0.0.2:11811")));
  EXPECT_EQ(look_up_servers("10.0.0.2;discovery_2.invalid:11811").unknown,
            Texts{"discovery_2.invalid:11811"});
}

TEST(ServerList, MalformedServersAreToldFromUnknownHosts) {
  for (const char* text : {"10.0.0.1:0", "10.0.0.1:70000", "a b", "10.0.0.300", "[::1]:11811", "::1"}) {
    const ServerList list = look_up_servers(std::string("10.0.0.2;") + text);
    EXPECT_EQ(list.found.size(), 1u) << text;
    EXPECT_EQ(list.malformed, Texts{text}) << text;
  }
}

TEST(ServerList, EveryHostNameIsLookedUp) {
  EXPECT_EQ(look_up_servers("beef.invalid:11811;dc1-.invalid").unknown.size(), 2u);
  const ServerList list = look_up_servers("localhost:11811");
  ASSERT_EQ(list.found.size(), 1u);
  EXPECT_EQ(places(list), places(look_up_servers("127.0.0.1:11811")));
}

TEST(ServerList, AnEmptyListNamesNoServer) {
  for (const char* text : {"", ";", ";;;"}) EXPECT_TRUE(look_up_servers(text).found.empty()) << text;
}

}  // namespace
}  // namespace coppice
