// Sizes of UDP datagrams.
#pragma once

namespace coppice {

/// Bytes. Fits an Ethernet frame, also inside the tunnels of containers and VPNs. IP cuts a larger datagram
/// into fragments, and losing one fragment loses the datagram: where a fifth of the frames is lost, 99 of 100
/// maps of 32 KB in one datagram are lost. DDS cuts larger samples itself and sends each missing part again.
inline constexpr int datagram_for_networks = 1344;
/// Bytes. Where all processes run on one host, IP cuts nothing, and large datagrams halve their number.
inline constexpr int datagram_for_one_host = 65'500;

/// The receive buffer that a socket requests, in bytes. Two hundred processes announce themselves at once,
/// and the usual 200 KB overflow. The system may grant less.
inline constexpr int wanted_receive_buffer = 4 << 20;

}  // namespace coppice
