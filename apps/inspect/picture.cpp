#include "apps/inspect/picture.hpp"

#include <ft2build.h>
#include <png.h>

#include <algorithm>
#include <functional>
#include <iomanip>
#include <locale>
#include <sstream>
#include <stdexcept>
#include FT_FREETYPE_H

namespace clearway {
namespace {

constexpr Picture::Colour ink{50, 56, 62};

/// FreeType's font, loaded when something is first written. For one thread.
class Font {
 public:
  Font() {
    if (FT_Init_FreeType(&library_) != 0 || FT_New_Face(library_, CLEARWAY_FONT, 0, &face_) != 0)
      throw std::runtime_error("the font " CLEARWAY_FONT
                               " cannot be read, expected it as package fonts-dejavu-core installs it");
  }
  ~Font() { FT_Done_FreeType(library_); }
  Font(const Font&) = delete;
  Font& operator=(const Font&) = delete;

  /// Calls `use(glyph, x)` for each letter, x from 0 on. Returns where the text ends.
  int walk(const std::string& text, int size, const std::function<void(const FT_GlyphSlot&, int)>& use) {
    FT_Set_Pixel_Sizes(face_, 0, static_cast<FT_UInt>(size));
    int x = 0;
    const auto draw = [&](FT_ULong letter) {
      if (FT_Load_Char(face_, letter, FT_LOAD_RENDER) != 0) return;
      use(face_->glyph, x);
      x += static_cast<int>(face_->glyph->advance.x >> 6);
    };
    for (std::size_t at = 0; at < text.size();) {
      const FT_ULong letter = next_letter(text, at);
      if (FT_Get_Char_Index(face_, letter) != 0) {
        draw(letter);
      } else {
        for (const char spelt : spelling(letter)) draw(static_cast<unsigned char>(spelt));
      }
    }
    return x;
  }

 private:
  /// Of a letter that the font lacks, in letters that it has: U+65E5.
  static std::string spelling(FT_ULong letter) {
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text << "U+" << std::hex << std::uppercase << std::setw(4) << std::setfill('0') << letter;
    return text.str();
  }

  /// The next code point of UTF-8; what is none becomes U+FFFD.
  static FT_ULong next_letter(const std::string& text, std::size_t& at) {
    const auto first = static_cast<unsigned char>(text[at++]);
    if (first < 0x80) return first;
    const int more = first >= 0xf0 && first < 0xf8 ? 3 : first >= 0xe0 ? 2 : 1;
    if (first < 0xc2 || first >= 0xf8) return 0xfffd;
    FT_ULong code = first & (0x3fU >> more);
    for (int i = 0; i < more; ++i) {
      if (at >= text.size() || (static_cast<unsigned char>(text[at]) & 0xc0U) != 0x80U) return 0xfffd;
      code = code << 6U | (static_cast<unsigned char>(text[at++]) & 0x3fU);
    }
    return code;
  }

  FT_Library library_ = nullptr;
  FT_Face face_ = nullptr;
};

Font& font() {
  static Font loaded;
  return loaded;
}

}  // namespace

Picture::Picture(int width, int height, const Colour& paper)
    : width_(width),
      height_(height),
      pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), paper) {}

void Picture::set(int x, int y, const Colour& colour) {
  if (x >= 0 && y >= 0 && x < width_ && y < height_) pixels_[index(x, y)] = colour;
}

void Picture::fill(int x0, int y0, int x1, int y1, const Colour& colour) {
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) set(x, y, colour);
}

void Picture::outline(int x0, int y0, int x1, int y1, const Colour& colour) {
  fill(x0, y0, x1, y0, colour);
  fill(x0, y1, x1, y1, colour);
  fill(x0, y0, x0, y1, colour);
  fill(x1, y0, x1, y1, colour);
}

void Picture::write(const std::string& text, int x, int y, int size) {
  font().walk(text, size, [&](const FT_GlyphSlot& glyph, int from) {
    const FT_Bitmap& bitmap = glyph->bitmap;
    for (int row = 0; row < static_cast<int>(bitmap.rows); ++row)
      for (int column = 0; column < static_cast<int>(bitmap.width); ++column) {
        const int share = bitmap.buffer[row * bitmap.pitch + column];
        const int px = x + from + glyph->bitmap_left + column, py = y - glyph->bitmap_top + row;
        if (share == 0 || px < 0 || py < 0 || px >= width_ || py >= height_) continue;
        Colour& pixel = pixels_[index(px, py)];
        for (std::size_t k = 0; k < 3; ++k)
          pixel[k] = static_cast<std::uint8_t>((pixel[k] * (255 - share) + ink[k] * share + 127) / 255);
      }
  });
}

int Picture::text_width(const std::string& text, int size) {
  return font().walk(text, size, [](const FT_GlyphSlot&, int) {});
}

std::string Picture::shortened(std::string text, int width, int size) {
  if (text_width(text, size) <= width) return text;
  while (!text.empty() && text_width(text + "...", size) > width) {
    while (text.size() > 1 && (static_cast<unsigned char>(text.back()) & 0xc0U) == 0x80U) text.pop_back();
    text.pop_back();
  }
  return text + "...";
}

std::string Picture::png() const {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width_);
  image.height = static_cast<png_uint_32>(height_);
  image.format = PNG_FORMAT_RGB;
  static_assert(sizeof(Colour) == 3);
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels_.data(), 3 * width_, nullptr) == 0)
    throw std::runtime_error(std::string("cannot make a picture: ") + image.message);
  bytes.resize(size);
  return bytes;
}

}  // namespace clearway
