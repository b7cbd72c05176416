#include "files/picture_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <csetjmp>
#include <cstring>
#include <memory>
#include <string_view>

#include <fmt/format.h>
#include <png.h>

#include "coppice/files/input_error.h"
#include "coppice/files/map_file.h"
#include "files/text_file.h"

namespace coppice {

namespace {

constexpr std::size_t largest_deflation = 1032;  // most bytes that one deflated byte can stand for
constexpr std::string_view png_signature = "\x89PNG\r\n\x1a\n";

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& problem) {
  throw InputError(fmt::format("{}: {}", path.string(), problem));
}

void check_size(const std::filesystem::path& path, long width, long height) {
  if (width < 1 || height < 1 || width > largest_map_file_side || height > largest_map_file_side) {
    fail(path, fmt::format("size {} x {} is out of range, expected 1 to {} pixels a side", width, height,
                           largest_map_file_side));
  }
}

/// Reads the next whole number of a PGM header or of a plain (P2) picture; skips comments.
long next_number(const std::string& data, std::size_t& at, const std::filesystem::path& path) {
  while (at < data.size() && (std::isspace(static_cast<unsigned char>(data[at])) != 0 || data[at] == '#')) {
    if (data[at] == '#') {
      while (at < data.size() && data[at] != '\n') ++at;
    } else {
      ++at;
    }
  }
  long value = 0;
  const std::size_t begin = at;
  while (at < data.size() && data[at] >= '0' && data[at] <= '9' && at - begin < 9)
    value = value * 10 + (data[at++] - '0');
  if (at == begin) fail(path, fmt::format("truncated or malformed PGM: expected a number at byte {}", at));
  return value;
}

Picture read_pgm(const std::string& data, const std::filesystem::path& path) {
  const std::string magic = data.substr(0, 2);
  std::size_t at = 2;
  const long width = next_number(data, at, path);
  const long height = next_number(data, at, path);
  const long white = next_number(data, at, path);
  check_size(path, width, height);
  if (white < 1 || white > 65535)
    fail(path, fmt::format("largest value {} is out of range, expected 1 to 65535", white));
  Picture picture{static_cast<int>(width), static_cast<int>(height), 1, {}};
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  const std::size_t bytes = white > 255 ? 2 : 1;
  if (magic == "P5" && data.size() < at + 1 + pixels * bytes) {
    fail(path, fmt::format("truncated: {} x {} pixels need {} bytes, found {}", width, height, pixels * bytes,
                           data.size() - std::min(data.size(), at + 1)));
  }
  // Otherwise a file of a few bytes could allocate the memory of a large map.
  if (magic == "P2" && (data.size() - at) / 2 < pixels)
    fail(path, fmt::format("truncated: {} x {} pixels need more than {} bytes", width, height, data.size()));
  ++at;  // the one white space that ends the header; two with Windows line ends
  if (magic == "P5" && data.substr(at - 1, 2) == "\r\n" && data.size() == at + 1 + pixels * bytes) ++at;
  picture.samples.reserve(pixels);
  for (std::size_t k = 0; k < pixels; ++k) {
    long value = 0;
    if (magic == "P2") {
      value = next_number(data, at, path);
    } else {
      for (std::size_t b = 0; b < bytes; ++b) value = value * 256 + static_cast<unsigned char>(data[at++]);
    }
    if (value > white) fail(path, fmt::format("pixel {} is {}, above the largest value {}", k, value, white));
    picture.samples.push_back(static_cast<std::uint8_t>(
        std::lround(255.0 * static_cast<double>(value) / static_cast<double>(white))));
  }
  return picture;
}

/// Reads a PNG picture with libpng. On an error libpng leaves its functions by longjmp, which runs no
/// destructors. So no object with a destructor is created between setjmp and the calls of libpng.
class PngReader {
 public:
  explicit PngReader(std::string_view data)
      : rest_(data), png_(png_create_read_struct(PNG_LIBPNG_VER_STRING, this, on_error, on_warning)) {
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
    if (info_ == nullptr) throw std::bad_alloc();
    png_set_read_fn(png_, this, read);
  }
  ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;

  const char* problem() const { return problem_.data(); }
  long width() const { return static_cast<long>(png_get_image_width(png_, info_)); }
  long height() const { return static_cast<long>(png_get_image_height(png_, info_)); }
  int channels() const { return png_get_channels(png_, info_); }

  /// Reads the header and sets the conversions: 8 bits a sample, palettes expanded to colours, alpha where a
  /// colour stands for transparent; gamma and colour profiles are ignored. Returns false on an error.
  bool read_header() {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_read_info(png_, info_);
    png_set_expand(png_);
    png_set_scale_16(png_);
    png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
    return true;
  }
  bool read_rows(png_bytepp rows) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_read_image(png_, rows);
    png_read_end(png_, nullptr);
    return true;
  }

 private:
  static void read(png_structp png, png_bytep to, std::size_t count) {
    auto& self = *static_cast<PngReader*>(png_get_io_ptr(png));
    if (count > self.rest_.size()) png_error(png, "the file ends too early");
    std::memcpy(to, self.rest_.data(), count);
    self.rest_.remove_prefix(count);
  }
  [[noreturn]] static void on_error(png_structp png, png_const_charp problem) {
    auto& self = *static_cast<PngReader*>(png_get_error_ptr(png));
    const std::string_view text(problem);
    std::copy_n(text.begin(), std::min(text.size(), self.problem_.size() - 1), self.problem_.begin());
    png_longjmp(png, 1);
  }
  static void on_warning(png_structp, png_const_charp) {}

  std::string_view rest_;
  std::array<char, 200> problem_{};
  png_structp png_;
  png_infop info_ = nullptr;
};

Picture read_png(const std::string& data, const std::filesystem::path& path) {
  PngReader png(data);
  const auto refuse = [&] { fail(path, fmt::format("cannot be read as PNG: {}", png.problem())); };
  if (!png.read_header()) refuse();
  check_size(path, png.width(), png.height());
  // The same check as for a PGM picture. A pixel takes at least 1 bit.
  const std::size_t pixels = static_cast<std::size_t>(png.width()) * static_cast<std::size_t>(png.height());
  const std::size_t least = pixels / 8 / largest_deflation;
  if (data.size() < least)
    fail(path, fmt::format("truncated: {} x {} pixels need more than {} bytes, found {}", png.width(),
                           png.height(), least, data.size()));
  Picture picture{static_cast<int>(png.width()), static_cast<int>(png.height()), png.channels(), {}};
  picture.samples.resize(pixels * static_cast<std::size_t>(picture.channels));
  const std::size_t row_size = picture.samples.size() / static_cast<std::size_t>(picture.height);
  std::vector<png_bytep> rows;
  for (std::size_t at = 0; at < picture.samples.size(); at += row_size)
    rows.push_back(picture.samples.data() + at);
  if (!png.read_rows(rows.data())) refuse();
  return picture;
}

/// Recognises other picture formats by their first bytes, for error messages. Empty: unknown.
std::string_view other_kind(std::string_view data) {
  struct Kind {
    std::string_view begins;
    std::string_view name;
  };
  using namespace std::string_view_literals;
  static constexpr std::array kinds{Kind{"\xff\xd8\xff"sv, "JPEG"},
                                    Kind{"BM"sv, "BMP"},
                                    Kind{"GIF8"sv, "GIF"},
                                    Kind{"II*\0"sv, "TIFF"},
                                    Kind{"MM\0*"sv, "TIFF"},
                                    Kind{"RIFF"sv, "WebP"},
                                    Kind{"P1"sv, "PBM"},
                                    Kind{"P4"sv, "PBM"},
                                    Kind{"P3"sv, "PPM"},
                                    Kind{"P6"sv, "PPM"},
                                    Kind{"P7"sv, "PAM"}};
  const auto kind = std::ranges::find_if(kinds, [&](const Kind& k) { return data.starts_with(k.begins); });
  return kind == kinds.end() ? ""sv : kind->name;
}

}  // namespace

Picture read_picture(const std::filesystem::path& path) {
  const std::string data = read_file(path);
  if (data.starts_with(png_signature)) return read_png(data, path);
  if (data.starts_with("P2") || data.starts_with("P5")) return read_pgm(data, path);
  const std::string_view kind = other_kind(data);
  fail(path, kind.empty() ? "is neither a PNG nor a PGM picture"
                          : fmt::format("is a {} picture, expected PNG or PGM", kind));
}

}  // namespace coppice
