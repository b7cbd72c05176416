// Sizes of UDP datagrams.
#pragma once

namespace coppice {

/// Fits an Ethernet frame, also within the tunnels of containers and VPNs. What is larger IP would cut into
/// fragments, and whoever loses one of these loses all: of maps of 32 KB in one datagram, where a fifth of
/// the frames is lost, 99 of 100. What is larger than this DDS cuts, and sends each part again that is
/// missing. Bytes.
inline constexpr int datagram_for_networks = 1344;
/// Where all processes are on one host, nothing is cut, and large ones save half of all datagrams.
inline constexpr int datagram_for_one_host = 65'500;

/// What a socket asks for, bytes: two hundred processes announce themselves at once, and the usual 200 KB
/// overflow. The system may grant less.
inline constexpr int wanted_receive_buffer = 4 << 20;

}  // namespace coppice
