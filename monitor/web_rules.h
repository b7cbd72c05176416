// What the web server answers whom, apart from any socket: so that it can be looked over, and tested.
//
// A monitor shows a fleet to whoever sits at this machine. What a browser there may be led to by other sites
// is kept out: a site that has its own name point to this machine (DNS rebinding) by the Host of its
// requests, and one that connects across origins by their Origin (RFC 6455, 10.2), which pages cannot forge.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace coppice {

/// The page of Foxglove's own site, which connects to the machine it is shown on.
inline constexpr std::string_view foxglove_origin = "https://app.foxglove.dev";

/// Whether a request that names this Host may be meant for us: by an IP address, or "localhost"; any other
/// name may be somebody else's. With a port or without, for ports may be forwarded.
bool is_fine_host(std::string_view host);

/// Whether a page of that origin was loaded from the host that it now connects to.
bool is_same_origin(std::string_view origin, std::string_view host);

/// The two that talk over WebSockets.
enum class Channel : unsigned char { page, foxglove };

/// The first of those that a client offers that Foxglove speaks. `subprotocols` is the header's text.
std::optional<std::string_view> foxglove_subprotocol(std::string_view subprotocols);

/// Foxglove asks for its subprotocol, wherever; the page for its path.
std::optional<Channel> channel_of(std::string_view path, std::string_view subprotocols);

/// Whether it may connect. Programs send no origin (it is empty); pages do. `others`: origins for which
/// Foxglove's channel is open, too.
bool may_connect(Channel channel, std::string_view origin, std::string_view host,
                 const std::vector<std::string>& others);

/// Of a request's target, without the query.
std::string_view path_of(std::string_view target);

/// By the file's extension.
std::string_view media_type(std::string_view path);

}  // namespace coppice
