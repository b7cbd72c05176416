// Cells of a map as bits, cell k in bit k % 8 of octet k / 8: as maps go over the network, into recordings,
// and to the page.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace coppice {

/// `Octets`: a std::string, or a vector of octets. A cell is set where it is not 0.
template <class Octets>
Octets packed_cells(const std::vector<std::uint8_t>& cells) {
  Octets bits((cells.size() + 7) / 8, 0);
  for (std::size_t k = 0; k < cells.size(); ++k) {
    if (cells[k] != 0) bits[k / 8] = static_cast<typename Octets::value_type>(bits[k / 8] | 1 << k % 8);
  }
  return bits;
}

/// As many as are asked for, and as the bits hold.
template <class Octets>
std::vector<std::uint8_t> unpacked_cells(const Octets& bits, std::size_t count) {
  std::vector<std::uint8_t> cells(std::min(count, bits.size() * 8));
  for (std::size_t k = 0; k < cells.size(); ++k)
    cells[k] = static_cast<std::uint8_t>(static_cast<std::uint8_t>(bits[k / 8]) >> k % 8 & 1);
  return cells;
}

}  // namespace coppice
