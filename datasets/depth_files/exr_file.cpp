#include "datasets/depth_files/exr_file.hpp"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "datasets/cameras/lower_case.hpp"

namespace clearway {
namespace {

class ByteStream final : public Imf::IStream {
 public:
  explicit ByteStream(const std::string& bytes) : IStream("picture"), bytes_(bytes) {}

  bool read(char* to, int count) override {
    if (count < 0 || static_cast<std::size_t>(count) > bytes_.size() - at_)
      throw std::runtime_error("it is cut off");
    std::memcpy(to, &bytes_[at_], static_cast<std::size_t>(count));
    at_ += static_cast<std::size_t>(count);
    return at_ < bytes_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t at) override { at_ = std::min<std::uint64_t>(at, bytes_.size()); }

 private:
  const std::string& bytes_;
  std::size_t at_ = 0;
};

/// What stands behind the last point of a channel's name, in small letters: "z" of "ViewLayer.Depth.Z".
std::string last_word(std::string_view channel) {
  const std::size_t point = channel.rfind('.');
  return lower_case(std::string(point == std::string_view::npos ? channel : channel.substr(point + 1)));
}

bool is_of_depth(std::string_view channel) {
  const std::string word = last_word(channel);
  const bool is_of_layer = lower_case(std::string(channel)).find("depth") != std::string::npos;
  return word == "z" || word == "depth" || (word == "v" && is_of_layer);
}

/// The channels that have to hold the same: one, or R, G and B.
std::vector<std::string> channels_of_depth(const Imf::ChannelList& list) {
  std::vector<std::string> all, depth;
  for (auto channel = list.begin(); channel != list.end(); ++channel) {
    if (last_word(channel.name()) == "a") continue;  // alpha
    all.emplace_back(channel.name());
    if (is_of_depth(channel.name())) depth.emplace_back(channel.name());
  }
  if (depth.size() == 1 || all.size() == 1) return depth.size() == 1 ? depth : all;
  const bool is_rgb =
      depth.empty() && all.size() == 3 && std::all_of(all.begin(), all.end(), [](const std::string& name) {
        return std::string_view("rgb").find(last_word(name)) != std::string_view::npos;
      });
  if (!is_rgb)
    throw std::runtime_error("it has " + std::to_string(all.size()) + " channels, " +
                             (depth.empty() ? "none" : std::to_string(depth.size())) +
                             " of them called depth or Z: expected one of depth");
  return all;
}

DepthPicture depth_in(Imf::InputFile& file) {
  const Imath::Box2i window = file.header().dataWindow();
  if (window != file.header().displayWindow())
    throw std::runtime_error("it holds a part of its picture alone: expected all of it");
  const ImageSize size = require_picture_size(std::int64_t{window.max.x} - window.min.x + 1,
                                              std::int64_t{window.max.y} - window.min.y + 1);
  DepthPicture picture{size, {}, true};
  const auto width = static_cast<std::size_t>(picture.size.width);
  const std::size_t pixels = width * static_cast<std::size_t>(picture.size.height);
  for (const std::string& channel : channels_of_depth(file.header().channels())) {
    std::vector<float> values(pixels);
    Imf::FrameBuffer buffer;
    buffer.insert(channel,
                  Imf::Slice::Make(Imf::FLOAT, values.data(), window, sizeof(float), width * sizeof(float)));
    file.setFrameBuffer(buffer);
    file.readPixels(window.min.y, window.max.y);
    if (!picture.values.empty() &&
        std::memcmp(picture.values.data(), values.data(), pixels * sizeof(float)) != 0)
      throw std::runtime_error("it holds colours: expected one number of depth in each pixel");
    picture.values = std::move(values);
  }
  return picture;
}

}  // namespace

bool is_exr(const std::string& bytes) { return bytes.starts_with("\x76\x2f\x31\x01"); }

DepthPicture decode_exr(const std::string& bytes) {
  constexpr unsigned deep = 0x08, multipart = 0x10;  // of the second byte behind the magic number
  if (bytes.size() > 5 && (static_cast<unsigned char>(bytes[5]) & (deep | multipart)) != 0)
    throw std::runtime_error("it has several parts, or several depths in a pixel: expected one picture");
  try {
    ByteStream stream(bytes);
    Imf::InputFile file(stream, 0);
    return depth_in(file);
  } catch (const Iex::BaseExc&) {
    throw std::runtime_error("it cannot be decoded");
  }
}

}  // namespace clearway
