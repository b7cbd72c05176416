// Tests of the page and the API behind proxies with TLS: those of Debian, with the configurations of
// docs/api.md. tests/run installs them, and chromium.
//
// CTest: RESOURCE_LOCK browser_2

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/domains.h"
#include "tests/processes.h"
#include "tests/support.h"
#include "tests/web/client.h"
#include "tests/web/packages.h"

namespace coppice {
namespace {

using namespace std::chrono_literals;

constexpr const char* token = "0123456789abcdef";

struct Proxy : testing::Test {
  const std::string page_host = fmt::format("fleet.localhost:{}", test::free_port());  ///< chromium knows it
  const std::uint16_t port = test::free_port();
  test::TemporaryFolder folder;
  std::unique_ptr<test::Background> fleet;
  std::unique_ptr<test::Background> monitor;

  std::string path(const std::string& name) const { return (folder.path() / name).string(); }
  std::string said(const std::string& name) const { return test::contents(path(name)); }

  void SetUp() override {
    ASSERT_EQ(test::missing_for_browser(), "");
    ASSERT_EQ(test::shell("command -v caddy && command -v nginx").exit_code, 0)
        << "needs caddy and nginx, which tests/run installs";
    folder.write("token", token);
    fleet = std::make_unique<test::Background>(
        std::vector<std::string>{
            test::program("coppice"), "serve", (test::scenarios() / "rooms-8.json").string(), "--robots", "4",
            "--domain", test::domain_name(), "--quiet", "--time-scale", "2", "--state", path("state")},
        path("fleet.log"));
    monitor = std::make_unique<test::Background>(
        std::vector<std::string>{test::program("coppice"), "monitor", "--domain", test::domain_name(),
                                 "--port", std::to_string(port), "--proxy-origin", "https://" + page_host,
                                 "--control", "--token-file", path("token")},
        path("monitor.log"));
    EXPECT_TRUE(test::within(20s, [&] { return said("monitor.log").starts_with("http://"); }))
        << said("monitor.log");
    EXPECT_EQ(
        test::shell(fmt::format("openssl req -x509 -newkey rsa:2048 -nodes -days 1 -subj /CN=fleet.localhost "
                                "-addext subjectAltName=DNS:fleet.localhost -keyout '{}' -out '{}' 2>&1",
                                path("fleet.key"), path("fleet.pem")))
            .exit_code,
        0);
  }

  /// The configuration of docs/api.md that contains `mark`, for this fleet. `changes`: what else differs.
  std::string configuration(const std::string& mark,
                            std::vector<std::pair<std::string, std::string>> changes) {
    const std::string page = test::contents(std::filesystem::path(COPPICE_SOURCE_DIR) / "docs/api.md");
    const std::size_t at = page.find(mark);
    const std::size_t begin = page.rfind("\n\n", at) + 2;
    std::string text = page.substr(begin, page.find("\n\n", at) - begin);
    changes.emplace_back("127.0.0.1:8090", fmt::format("127.0.0.1:{}", port));
    for (const auto& [usual, own] : changes) {
      const std::size_t place = text.find(usual);
      EXPECT_NE(place, std::string::npos) << usual << " is not in the example: " << text;
      if (place != std::string::npos) text.replace(place, usual.size(), own);
    }
    return text;
  }

  void use_page(const std::string& log) const {
    const std::string address = "https://" + page_host + "/";
    EXPECT_TRUE(test::within(20s, [&] {
      return test::shell(fmt::format("curl -sk --resolve '{}:127.0.0.1' '{}healthz'", page_host, address))
                 .output == "ok\n";
    })) << said(log);
    const test::Outcome outcome = test::shell(
        fmt::format("COPPICE_PAGE_URL={} COPPICE_PAGE_TOKEN={} node '{}/page/proxy.spec.mjs' 2>&1", address,
                    token, test::web_tests().string()));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output << said(log) << said("monitor.log")
                                    << said("fleet.log");
    const test::Outcome foreign = test::shell(fmt::format(
        "curl -sk --resolve '{}:127.0.0.1' -o /dev/null -w '%{{http_code}}' -H 'Authorization: Bearer {}' "
        "-H 'Origin: https://evil.example' '{}api/robots'",
        page_host, token, address));
    EXPECT_EQ(foreign.output, "403") << "pages of other sites are refused as ever";
    test::shell(
        fmt::format("curl -sk --resolve '{}:127.0.0.1' -H 'Authorization: Bearer wrong' "
                    "-H 'X-Forwarded-For: 192.0.2.7' '{}api/robots'",
                    page_host, address));
    EXPECT_NE(said("monitor.log").find("127.0.0.1 showed a wrong token"), std::string::npos)
        << "what a client makes up does not count: " << said("monitor.log");
  }
};

TEST_F(Proxy, ThePageWorksBehindCaddy) {
  const std::string global = fmt::format(
      "{{\n  admin off\n  auto_https disable_redirects\n  skip_install_trust\n  storage file_system {}\n}}\n",
      path("storage"));
  folder.write("Caddyfile", global + configuration("reverse_proxy", {{"fleet.example", page_host}}));
  const test::Background caddy({"/usr/bin/env", "HOME=" + folder.path().string(), "caddy", "run", "--config",
                                path("Caddyfile"), "--adapter", "caddyfile"},
                               path("caddy.log"));
  use_page("caddy.log");
}

TEST_F(Proxy, ThePageWorksBehindNginx) {
  const std::string server = configuration(
      "proxy_pass",
      {{"listen 443 ssl", fmt::format("listen 127.0.0.1:{} ssl", page_host.substr(page_host.find(':') + 1))},
       {"fleet.example", "fleet.localhost"},
       {"/etc/ssl/fleet.pem", path("fleet.pem")},
       {"/etc/ssl/fleet.key", path("fleet.key")}});
  folder.write(
      "nginx.conf",
      fmt::format("daemon off;\nmaster_process off;\npid {0}/nginx.pid;\nerror_log stderr;\nevents "
                  "{{}}\nhttp {{\naccess_log off;\n"
                  "client_body_temp_path {0}/body;\nproxy_temp_path {0}/proxy;\nfastcgi_temp_path {0}/f;\n"
                  "uwsgi_temp_path {0}/u;\nscgi_temp_path {0}/s;\n{1}\n}}\n",
                  folder.path().string(), server));
  const test::Background nginx({"/usr/sbin/nginx", "-e", "stderr", "-c", path("nginx.conf")},
                               path("nginx.log"));
  use_page("nginx.log");
}

}  // namespace
}  // namespace coppice
