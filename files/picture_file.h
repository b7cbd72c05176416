// Reads pictures of maps, PNG or PGM, which are recognised by their content.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace coppice {

/// The samples of a file scaled to 0..255, without gamma and colour profile.
struct Picture {
  int width = 0;
  int height = 0;
  int channels = 1;                   ///< 1: grey, 2: grey and alpha, 3: colours, 4: colours and alpha
  std::vector<std::uint8_t> samples;  ///< pixel by pixel, row by row from the top

  /// Grey value from 0 (black) to 255 (white): the mean of the colours.
  double shade(std::size_t pixel) const {
    const std::uint8_t* p = samples.data() + pixel * static_cast<std::size_t>(channels);
    return channels < 3 ? p[0] : (p[0] + p[1] + p[2]) / 3.0;
  }
  bool is_opaque(std::size_t pixel) const {
    return channels % 2 == 1 || samples[(pixel + 1) * static_cast<std::size_t>(channels) - 1] == 255;
  }
};

/// Throws InputError, which names the file, if the file is neither a PNG nor a PGM picture, or is damaged.
Picture read_picture(const std::filesystem::path& path);

}  // namespace coppice
