// Packs the cells of a map as bits: cell k is bit k % 8 of octet k / 8. The network, recordings and the page
// use this format.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace coppice {

/// `Octets`: a std::string, or a vector of octets. Cells that are not 0 become set bits.
template <class Octets>
Octets packed_cells(const std::vector<std::uint8_t>& cells) {
  Octets bits((cells.size() + 7) / 8, 0);
  for (std::size_t k = 0; k < cells.size(); ++k) {
    if (cells[k] != 0) bits[k / 8] = static_cast<typename Octets::value_type>(bits[k / 8] | 1 << k % 8);
  }
  return bits;
}

/// Unpacks `count` cells, or as many as the bits hold.
template <class Octets>
std::vector<std::uint8_t> unpacked_cells(const Octets& bits, std::size_t count) {
  std::vector<std::uint8_t> cells(std::min(count, bits.size() * 8));
  for (std::size_t k = 0; k < cells.size(); ++k)
    cells[k] = static_cast<std::uint8_t>(static_cast<std::uint8_t>(bits[k / 8]) >> k % 8 & 1);
  return cells;
}

}  // namespace coppice
