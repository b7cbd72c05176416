// The access rules of the web server, apart from any socket, so that they can be reviewed and tested.
//
// A monitor shows a fleet to everybody at this machine, and obeys those who show its token. It refuses
// requests that other sites cause in a browser here: a site whose name points to this machine (DNS rebinding)
// is recognised by the Host, and a connection across origins by the Origin (RFC 6455, 10.2), which pages
// cannot forge.
//
// A proxy serves the page under another name. Its operator lists the origins that browsers then see. No
// header that a proxy adds, and a client could forge, widens what is allowed.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace coppice {

/// The origin of Foxglove's own site. Its page connects to the machine on which it is shown.
inline constexpr std::string_view foxglove_origin = "https://app.foxglove.dev";

/// An origin as browsers say it (RFC 6454, 6.2): http:// or https://, a name or an address, and perhaps a
/// port.
bool is_origin(std::string_view text);

/// The origins of proxies before this server.
using ProxyOrigins = std::vector<std::string>;

/// Whether this Host may mean this server: an IP address, "localhost" or the name of a proxy, with or without
/// a port, because ports may be forwarded. Any other name may belong to another site.
bool is_fine_host(std::string_view host, const ProxyOrigins& proxies = {});

/// Whether a page of that origin was loaded from this host, or through a proxy.
bool is_same_origin(std::string_view origin, std::string_view host, const ProxyOrigins& proxies = {});

/// The address that the nearest proxy says it asks for: the last one of an X-Forwarded-For. A client may have
/// made up those before it. Empty: that is no IP address.
std::string_view last_address(std::string_view forwarded_for);

/// The two kinds of WebSocket clients.
enum class Channel : unsigned char { page, foxglove };

/// The first of the offered subprotocols that Foxglove uses. `subprotocols` is the header's text.
std::optional<std::string_view> foxglove_subprotocol(std::string_view subprotocols);

/// Foxglove is recognised by its subprotocol, on any path; a page by its path.
std::optional<Channel> channel_of(std::string_view path, std::string_view subprotocols);

/// Whether a client may connect. Programs send no origin (it is empty); pages do. `others`: further origins
/// that may connect as Foxglove.
bool may_connect(Channel channel, std::string_view origin, std::string_view host,
                 const std::vector<std::string>& others, const ProxyOrigins& proxies = {});

/// Whether a path belongs to the HTTP API, which controls the fleet.
bool is_of_api(std::string_view path);

/// What a request to the API may do.
enum class ApiAccess : unsigned char {
  granted,
  absent,          ///< this server has no API
  foreign_origin,  ///< a page of another site sent it
  unauthorized,    ///< it does not show the token
};

/// `authorization`, `origin`, `host`: the texts of these headers. `token`: the server's; empty: it has no
/// API. The time for the comparison tells nothing of the token.
ApiAccess api_access(std::string_view authorization, std::string_view origin, std::string_view host,
                     std::string_view token, const ProxyOrigins& proxies = {});

/// The path of a request's target, without the query.
std::string_view path_of(std::string_view target);
/// The query of a request's target, without the question mark.
std::string_view query_of(std::string_view target);

/// A part of a path, decoded (RFC 3986, 2.1).
std::string decoded(std::string_view text);
/// The decoded names of a query's parameters, in their order.
std::vector<std::string> parameter_names(std::string_view query);
/// The decoded value of a parameter of a query: name=value, separated by &.
std::optional<std::string> query_value(std::string_view query, std::string_view name);

/// The media type of a file, by its extension.
std::string_view media_type(std::string_view path);

}  // namespace coppice
