#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace clearway {

/// A picture: pixels from the upper left corner, x to the right and y down. What lies outside is not drawn.
class Picture {
 public:
  using Colour = std::array<std::uint8_t, 3>;  ///< red, green, blue
  static constexpr int letters = 12;           ///< pixels of an em, as usual

  Picture(int width, int height, const Colour& paper);

  int width() const { return width_; }
  int height() const { return height_; }
  const Colour& at(int x, int y) const { return pixels_[index(x, y)]; }
  void set(int x, int y, const Colour& colour);

  /// Corners included.
  void fill(int x0, int y0, int x1, int y1, const Colour& colour);
  void outline(int x0, int y0, int x1, int y1, const Colour& colour);

  /// Writes UTF-8 in DejaVu Sans from the left end of the baseline.
  /// @throws std::runtime_error when the font is missing
  void write(const std::string& text, int x, int y, int size = letters);

  /// How wide `write` writes, pixels.
  static int text_width(const std::string& text, int size = letters);
  /// The text, or as much of its beginning as fits into `width` pixels, with "..." behind.
  static std::string shortened(std::string text, int width, int size = letters);

  /// As a PNG file. @throws std::runtime_error when libpng fails.
  std::string png() const;

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }

  int width_, height_;
  std::vector<Colour> pixels_;
};

}  // namespace clearway
