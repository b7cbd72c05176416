// Tests of which clients may connect to the monitor.

#include "monitor/server/web_rules.h"

#include <gtest/gtest.h>

namespace coppice {
namespace {

TEST(WebRules, HostsByAddressAreAcceptedAndNamesAreNot) {
  for (const char* host :
       {"127.0.0.1", "127.0.0.1:8090", "localhost", "LocalHost:1", "[::1]", "[::1]:8090", "192.168.1.7:80"})
    EXPECT_TRUE(is_fine_host(host)) << host;
  for (const char* host :
       {"", "evil.example", "evil.example:8090", "localhost.evil.example", "127.0.0.1.evil.example",
        "localhost:", "localhost:1:2", "[::1", "[::1]x", "[evil]", "127.1.evil", "127.0.0.1:99x",
        "localhost:123456", "a@localhost", " localhost"})
    EXPECT_FALSE(is_fine_host(host)) << host;
}

TEST(WebRules, AnOriginIsTheSameIfItNamesTheHost) {
  EXPECT_TRUE(is_same_origin("http://127.0.0.1:8090", "127.0.0.1:8090"));
  EXPECT_TRUE(is_same_origin("https://localhost", "LOCALHOST"));
  for (const char* origin :
       {"http://127.0.0.1:8091", "http://localhost:8090", "null", "127.0.0.1:8090", "file://127.0.0.1:8090",
        "http://127.0.0.1:8090.evil.example", "http://evil.example"})
    EXPECT_FALSE(is_same_origin(origin, "127.0.0.1:8090")) << origin;
}

TEST(WebRules, FoxgloveIsKnownByItsSubprotocolAndThePageByItsPath) {
  EXPECT_EQ(channel_of("/live", ""), Channel::page);
  EXPECT_EQ(channel_of("/", "foxglove.websocket.v1"), Channel::foxglove);
  EXPECT_EQ(channel_of("/live", "other, foxglove.websocket.v1 ,x"), Channel::foxglove);
  EXPECT_EQ(channel_of("/", "foxglove.sdk.v1"), Channel::foxglove);
  EXPECT_EQ(channel_of("/", "foxglove.websocket.v2"), std::nullopt);
  EXPECT_EQ(channel_of("/", ",, ,"), std::nullopt);
  EXPECT_EQ(channel_of("/other", ""), std::nullopt);
}

TEST(WebRules, TheFirstKnownFoxgloveSubprotocolIsChosen) {
  EXPECT_EQ(foxglove_subprotocol("foxglove.sdk.v1"), "foxglove.sdk.v1");
  EXPECT_EQ(foxglove_subprotocol("foxglove.sdk.v2, foxglove.sdk.v1,foxglove.websocket.v1"),
            "foxglove.sdk.v1");
  EXPECT_EQ(foxglove_subprotocol("foxglove.websocket.v1, foxglove.sdk.v1"), "foxglove.websocket.v1");
  EXPECT_EQ(foxglove_subprotocol("foxglove"), std::nullopt);
}

TEST(WebRules, ForeignPagesMayNotConnectExceptAsFoxglove) {
  const std::vector<std::string> others{"http://viewer.example:8080"};
  const auto may = [&](Channel channel, const char* origin) {
    return may_connect(channel, origin, "127.0.0.1:8090", others);
  };
  for (const Channel channel : {Channel::page, Channel::foxglove}) {
    EXPECT_TRUE(may(channel, ""));
    EXPECT_TRUE(may(channel, "http://127.0.0.1:8090"));
    EXPECT_FALSE(may(channel, "http://evil.example"));
    EXPECT_FALSE(may(channel, "https://app.foxglove.dev.evil.example"));
    EXPECT_FALSE(may(channel, "http://app.foxglove.dev"));
    EXPECT_FALSE(may(channel, "null"));
  }
  EXPECT_TRUE(may(Channel::foxglove, "https://app.foxglove.dev"));
  EXPECT_TRUE(may(Channel::foxglove, "http://viewer.example:8080"));
  EXPECT_FALSE(may(Channel::page, "https://app.foxglove.dev"));
  EXPECT_FALSE(may(Channel::page, "http://viewer.example:8080"));
}

/// The page at https://fleet.example, through a proxy that keeps the Host (Caddy) or not (nginx).
TEST(WebRules, APageBehindAProxyIsServedByTheNameThatWasGiven) {
  const ProxyOrigins proxies{"https://fleet.example"};
  for (const char* host : {"fleet.example", "Fleet.Example:443", "127.0.0.1:8090"}) {
    EXPECT_TRUE(is_fine_host(host, proxies)) << host;
    EXPECT_TRUE(is_same_origin("https://fleet.example", host, proxies)) << host;
    EXPECT_TRUE(may_connect(Channel::page, "https://fleet.example", host, {}, proxies)) << host;
    EXPECT_EQ(
        api_access("Bearer 0123456789abcdef", "https://fleet.example", host, "0123456789abcdef", proxies),
        ApiAccess::granted);
    for (const char* origin : {"http://fleet.example", "https://fleet.example:8443", "https://evil.example",
                               "https://fleet.example.evil.example", "null"}) {
      EXPECT_FALSE(is_same_origin(origin, host, proxies)) << origin << " at " << host;
      EXPECT_FALSE(may_connect(Channel::page, origin, host, {}, proxies)) << origin << " at " << host;
      EXPECT_EQ(api_access("Bearer 0123456789abcdef", origin, host, "0123456789abcdef", proxies),
                ApiAccess::foreign_origin)
          << origin << " at " << host;
    }
  }
  for (const char* host :
       {"evil.example", "fleet.example.evil.example", "fleet.example:x", "", "a.fleet.example"})
    EXPECT_FALSE(is_fine_host(host, proxies)) << host;
  EXPECT_FALSE(is_fine_host("fleet.example")) << "without the option";
}

TEST(WebRules, OriginsOfProxiesAreSchemeNameAndPort) {
  for (const char* origin : {"https://fleet.example", "http://fleet.example:8080", "https://[::1]:8443",
                             "https://192.0.2.1", "HTTPS://Fleet"})
    EXPECT_TRUE(is_origin(origin)) << origin;
  for (const char* origin :
       {"", "fleet.example", "https://", "https://fleet.example/", "https://fleet.example/page",
        "https://a b", "ftp://fleet.example", "https://fleet.example:", "https://fleet.example:x",
        "https://a:1:2", "https://[::1", "https://me@fleet.example", "*", "https://fleet.example?x"})
    EXPECT_FALSE(is_origin(origin)) << origin;
}

TEST(WebRules, TheNearestProxySaysForWhomItAsks) {
  EXPECT_EQ(last_address("192.0.2.7"), "192.0.2.7");
  EXPECT_EQ(last_address("10.0.0.1, 192.0.2.7"), "192.0.2.7");
  EXPECT_EQ(last_address("made up,  2001:db8::1 "), "2001:db8::1");
  for (const char* text : {"", "unknown", "192.0.2.7,", "192.0.2.7, x", "192.0.2.7:80"})
    EXPECT_EQ(last_address(text), "") << text;
}

TEST(WebRules, APathEndsBeforeTheQuery) {
  EXPECT_EQ(path_of("/metrics?x=1"), "/metrics");
  EXPECT_EQ(path_of("/#a"), "/");
  EXPECT_EQ(path_of("/a/b"), "/a/b");
  EXPECT_EQ(path_of(""), "");
}

TEST(WebRules, FilesHaveMediaTypes) {
  EXPECT_EQ(media_type("/index.html"), "text/html; charset=utf-8");
  EXPECT_EQ(media_type("/a.js"), "text/javascript; charset=utf-8");
  EXPECT_EQ(media_type("/a"), "application/octet-stream");
}

TEST(WebRules, TheApiNeedsTheTokenAndNoForeignOrigin) {
  constexpr const char* token = "0123456789abcdef";
  const auto access = [&](const char* authorization, const char* origin = "") {
    return api_access(authorization, origin, "127.0.0.1:8090", token);
  };
  EXPECT_EQ(access("Bearer 0123456789abcdef"), ApiAccess::granted);
  EXPECT_EQ(access("bearer 0123456789abcdef", "http://127.0.0.1:8090"), ApiAccess::granted);
  for (const char* wrong : {"", "Bearer", "Bearer ", "Bearer 0123456789abcdeg", "Bearer 0123456789abcde",
                            "Bearer 0123456789abcdef0", "Bearer 0123456789ABCDEF", "Basic 0123456789abcdef",
                            "0123456789abcdef", "Bearer 0123456789abcdef0123456789abcdef"})
    EXPECT_EQ(access(wrong), ApiAccess::unauthorized) << wrong;
  for (const char* origin : {"null", "http://evil.example", "https://app.foxglove.dev"})
    EXPECT_EQ(access("Bearer 0123456789abcdef", origin), ApiAccess::foreign_origin) << origin;
  EXPECT_EQ(api_access("Bearer ", "", "127.0.0.1", ""), ApiAccess::absent);
}

TEST(WebRules, TheApiHasPathsOfItsOwn) {
  for (const char* path : {"/api", "/api/", "/api/orders"}) EXPECT_TRUE(is_of_api(path)) << path;
  for (const char* path : {"", "/", "/apis", "/API", "/x/api"}) EXPECT_FALSE(is_of_api(path)) << path;
}

TEST(WebRules, QueriesAreDecoded) {
  EXPECT_EQ(query_of("/a?b=c&d#e?f"), "b=c&d");
  EXPECT_EQ(query_of("/a#b?c"), "");
  EXPECT_EQ(query_of("/a"), "");
  EXPECT_EQ(query_value("a=1&b=x%20y+z%2B&b=3", "b"), "x y z+");
  EXPECT_EQ(query_value("ab=1&b", "b"), "");
  EXPECT_EQ(query_value("&&ab=1&", "b"), std::nullopt);
  EXPECT_EQ(query_value("%62=1", "b"), "1");
  EXPECT_EQ(parameter_names("a=1&b%20c&&=d"), (std::vector<std::string>{"a", "b c", ""}));
  EXPECT_EQ(decoded("%7a%7A+%"), "zz+%");
  EXPECT_EQ(decoded("%4%g0%0"), "%4%g0%0");
}

}  // namespace
}  // namespace coppice
