#include "monitor/server/web_rules.h"

#include <algorithm>
#include <array>
#include <utility>

#include <arpa/inet.h>

#include "monitor/foxglove/foxglove.h"

namespace coppice {

namespace {

bool same_letters(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
  return std::ranges::equal(a, b, {}, lower, lower);
}

bool is_port(std::string_view text) {
  return !text.empty() && text.size() <= 5 &&
         std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
}

bool is_address(const std::string& text, int family) {
  std::array<unsigned char, sizeof(in6_addr)> address{};
  return inet_pton(family, text.c_str(), address.data()) == 1;
}

/// Without the scheme; empty: it has none that a page can have.
std::string_view host_of(std::string_view origin) {
  for (const std::string_view scheme : {"http://", "https://"}) {
    if (same_letters(origin.substr(0, scheme.size()), scheme)) return origin.substr(scheme.size());
  }
  return {};
}

/// Empty if what follows the name is no port.
std::string_view without_port(std::string_view host) {
  if (host.ends_with(']')) return host;
  const std::size_t colon = host.rfind(':');
  if (colon == std::string_view::npos) return host;
  return is_port(host.substr(colon + 1)) ? host.substr(0, colon) : std::string_view();
}

bool is_address_or_localhost(std::string_view host) {
  if (host.starts_with('[')) {
    const std::size_t end = host.find(']');
    if (end == std::string_view::npos) return false;
    const std::string_view rest = host.substr(end + 1);
    return (rest.empty() || (rest.starts_with(':') && is_port(rest.substr(1)))) &&
           is_address(std::string(host.substr(1, end - 1)), AF_INET6);
  }
  const std::size_t colon = host.find(':');
  if (colon != std::string_view::npos && !is_port(host.substr(colon + 1))) return false;
  const std::string_view name = host.substr(0, colon);
  return same_letters(name, "localhost") || is_address(std::string(name), AF_INET);
}

/// Looks at all characters, wherever the first difference is.
bool is_same_secret(std::string_view given, std::string_view secret) {
  unsigned difference = given.size() == secret.size() ? 0 : 1;
  for (std::size_t k = 0; k < given.size(); ++k)
    difference |=
        static_cast<unsigned char>(given[k]) ^ static_cast<unsigned char>(secret[k % secret.size()]);
  return difference == 0;
}

bool shows_token(std::string_view authorization, std::string_view token) {
  constexpr std::string_view scheme = "Bearer ";  // RFC 6750, 2.1
  return same_letters(authorization.substr(0, scheme.size()), scheme) &&
         is_same_secret(authorization.substr(scheme.size()), token);
}

int value_of_hex(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

}  // namespace

bool is_origin(std::string_view text) {
  const std::string_view host = host_of(text);
  if (host.empty() || host.find_first_of("/?#@ ,\\") != std::string_view::npos) return false;
  if (host.starts_with('[')) return is_address_or_localhost(host);
  const std::string_view name = without_port(host);
  return !name.empty() && name.find(':') == std::string_view::npos;
}

bool is_fine_host(std::string_view host, const ProxyOrigins& proxies) {
  const std::string_view asked = without_port(host);
  const bool is_proxy = !asked.empty() && std::ranges::any_of(proxies, [&](const std::string& proxy) {
    return same_letters(without_port(host_of(proxy)), asked);
  });
  return is_proxy || is_address_or_localhost(host);
}

std::string_view last_address(std::string_view forwarded_for) {
  std::string_view last = forwarded_for.substr(forwarded_for.rfind(',') + 1);
  while (last.starts_with(' ')) last.remove_prefix(1);
  while (last.ends_with(' ')) last.remove_suffix(1);
  const std::string text(last);
  return is_address(text, AF_INET) || is_address(text, AF_INET6) ? last : std::string_view();
}

bool is_same_origin(std::string_view origin, std::string_view host, const ProxyOrigins& proxies) {
  const auto is_proxy = [&](const std::string& proxy) { return same_letters(proxy, origin); };
  if (std::ranges::any_of(proxies, is_proxy)) return true;
  return is_address_or_localhost(host) && same_letters(host_of(origin), host);
}

std::optional<std::string_view> foxglove_subprotocol(std::string_view subprotocols) {
  while (!subprotocols.empty()) {
    const std::size_t comma = std::min(subprotocols.find(','), subprotocols.size());
    std::string_view one = subprotocols.substr(0, comma);
    while (one.starts_with(' ')) one.remove_prefix(1);
    while (one.ends_with(' ')) one.remove_suffix(1);
    const auto spoken = std::ranges::find(foxglove_subprotocols, one);
    if (spoken != foxglove_subprotocols.end()) return *spoken;
    subprotocols.remove_prefix(std::min(comma + 1, subprotocols.size()));
  }
  return std::nullopt;
}

std::optional<Channel> channel_of(std::string_view path, std::string_view subprotocols) {
  if (foxglove_subprotocol(subprotocols)) return Channel::foxglove;
  if (path == "/live") return Channel::page;
  return std::nullopt;
}

bool may_connect(Channel channel, std::string_view origin, std::string_view host,
                 const std::vector<std::string>& others, const ProxyOrigins& proxies) {
  if (origin.empty() || is_same_origin(origin, host, proxies)) return true;
  return channel == Channel::foxglove &&
         (origin == foxglove_origin || std::ranges::find(others, origin) != others.end());
}

bool is_of_api(std::string_view path) {
  return path == "/api" || path.starts_with("/api/");
}

ApiAccess api_access(std::string_view authorization, std::string_view origin, std::string_view host,
                     std::string_view token, const ProxyOrigins& proxies) {
  if (token.empty()) return ApiAccess::absent;
  if (!origin.empty() && !is_same_origin(origin, host, proxies)) return ApiAccess::foreign_origin;
  return shows_token(authorization, token) ? ApiAccess::granted : ApiAccess::unauthorized;
}

std::string_view path_of(std::string_view target) {
  return target.substr(0, target.find_first_of("?#"));
}

std::string_view query_of(std::string_view target) {
  target = target.substr(0, target.find('#'));
  const std::size_t mark = target.find('?');
  return mark == std::string_view::npos ? std::string_view() : target.substr(mark + 1);
}

std::string decoded(std::string_view text) {
  std::string plain;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const bool is_escape = text[k] == '%' && k + 2 < text.size() && value_of_hex(text[k + 1]) >= 0 &&
                           value_of_hex(text[k + 2]) >= 0;
    plain +=
        is_escape ? static_cast<char>(16 * value_of_hex(text[k + 1]) + value_of_hex(text[k + 2])) : text[k];
    if (is_escape) k += 2;
  }
  return plain;
}

std::vector<std::string> parameter_names(std::string_view query) {
  std::vector<std::string> names;
  while (!query.empty()) {
    const std::string_view one = query.substr(0, query.find('&'));
    query.remove_prefix(std::min(one.size() + 1, query.size()));
    if (!one.empty()) names.push_back(decoded(one.substr(0, one.find('='))));
  }
  return names;
}

std::optional<std::string> query_value(std::string_view query, std::string_view name) {
  while (!query.empty()) {
    const std::string_view one = query.substr(0, query.find('&'));
    query.remove_prefix(std::min(one.size() + 1, query.size()));
    const std::size_t equals = std::min(one.find('='), one.size());
    if (decoded(one.substr(0, equals)) != name) continue;
    std::string value(one.substr(std::min(equals + 1, one.size())));
    std::ranges::replace(value, '+', ' ');
    return decoded(value);
  }
  return std::nullopt;
}

std::string_view media_type(std::string_view path) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 9> types{{
      {".html", "text/html; charset=utf-8"},
      {".js", "text/javascript; charset=utf-8"},
      {".css", "text/css; charset=utf-8"},
      {".json", "application/json"},
      {".svg", "image/svg+xml"},
      {".png", "image/png"},
      {".ico", "image/x-icon"},
      {".woff2", "font/woff2"},
      {".txt", "text/plain; charset=utf-8"},
  }};
  for (const auto& [extension, type] : types) {
    if (path.ends_with(extension)) return type;
  }
  return "application/octet-stream";
}

}  // namespace coppice
