#include "datasets/pictures/video.hpp"

#include <dlfcn.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <new>
#include <opencv2/videoio.hpp>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "datasets/sources/decoding_child.hpp"
#include "datasets/sources/frame_bytes.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr std::uint64_t video_memory = 2048ULL << 20U;  ///< reference pictures, and room for its threads

/// Luma of a picture in blue, green, red (ITU-R BT.601). Not cv::cvtColor: its threads may be missing in a
/// forked process.
GrayImage luma(const cv::Mat& picture) {
  GrayImage image{picture.cols, picture.rows, {}};
  image.pixels.reserve(picture.total());
  const int channels = picture.channels();
  for (int row = 0; row < picture.rows; ++row) {
    const unsigned char* pixel = picture.ptr(row);
    for (int column = 0; column < picture.cols; ++column, pixel += channels) {
      const unsigned sum =
          channels < 3 ? 16384U * pixel[0] : 1868U * pixel[0] + 9617U * pixel[1] + 4899U * pixel[2];
      image.pixels.push_back(static_cast<std::uint8_t>((sum + 8192U) >> 14U));
    }
  }
  return image;
}

/// OpenCV's video, with the hundred libraries of ffmpeg, is loaded by the child that decodes one: nobody else
/// needs their 18 MB. Its C interface reads none any more, so the constructor is looked up; all other
/// functions of the class that are called are virtual.
class LoadedCapture {
 public:
  /// @throws std::runtime_error a clause that says why the file cannot be decoded.
  explicit LoadedCapture(const std::string& file) {
    void* const library = ::dlopen(CLEARWAY_VIDEOIO, RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) throw std::runtime_error("OpenCV's library for videos is not installed");
    using Construct = void (*)(void*);
    const auto construct = reinterpret_cast<Construct>(::dlsym(library, "_ZN2cv12VideoCaptureC1Ev"));
    if (construct == nullptr) throw std::runtime_error("OpenCV's library for videos is of another version");
    construct(memory_);
    capture_ = std::launder(reinterpret_cast<cv::VideoCapture*>(memory_));
    if (!capture_->open(file, cv::CAP_FFMPEG)) throw std::runtime_error("it cannot be decoded");
  }
  LoadedCapture(const LoadedCapture&) = delete;
  LoadedCapture& operator=(const LoadedCapture&) = delete;

  cv::VideoCapture* operator->() const { return capture_; }  // open until the child ends

 private:
  alignas(cv::VideoCapture) std::byte memory_[sizeof(cv::VideoCapture)];
  cv::VideoCapture* capture_ = nullptr;
};

/// What reads the video, in the child. `offset` of its messages is the share that is read, in millionths.
void decode_video(const ChildReport& report, const std::string& file, std::optional<double> rate) {
  std::optional<LoadedCapture> video;
  try {
    video.emplace(file);
  } catch (const std::runtime_error& error) {
    return report.send(ChildMessage::damage, 0, error.what());
  }
  LoadedCapture& capture = *video;
  const double count = capture->get(cv::CAP_PROP_FRAME_COUNT);
  const double own_rate = std::max(capture->get(cv::CAP_PROP_FPS), 1e-3);
  double last = -1.0;
  std::uint64_t number = 0;
  cv::Mat picture;
  for (; capture->read(picture) && !picture.empty(); ++number) {
    DecodedFrame decoded;
    const double told = capture->get(cv::CAP_PROP_POS_MSEC) / 1000.0;
    // Some containers tell no times: then those of a constant rate.
    const bool is_rising = std::isfinite(told) && told > last && (number == 0 || told > 0.0);
    last = is_rising ? told : static_cast<double>(number) / own_rate;
    decoded.frame.time = rate ? static_cast<double>(number) / *rate : last;
    ImageFrame image;
    image.image = luma(picture);
    decoded.frame.content = std::move(image);
    const double share = count > 0.0 ? std::min(1.0, static_cast<double>(number) / count) : 0.0;
    report.send(ChildMessage::frame, static_cast<std::uint64_t>(1e6 * share), frame_to_bytes(decoded));
  }
  if (number == 0) return report.send(ChildMessage::damage, 0, "it holds no picture that can be decoded");
  if (static_cast<double>(number) < count - 1.0)
    report.send(ChildMessage::skipped, 0,
                "it says that it holds " + std::to_string(std::llround(count)) + " pictures, and " +
                    std::to_string(number) + " could be decoded");
  report.send(ChildMessage::end, 1'000'000, "");
}

class Video final : public FrameSource {
 public:
  Video(const std::filesystem::path& file, const SourceOptions& options)
      : name_("video " + quote_path(file.string())),
        sensor_(file.stem().string()),
        camera_(options.camera),
        child_({.memory = video_memory, .seconds = DecodingLimits::of_file(file_size(file)).seconds}, -1,
               [path = std::filesystem::absolute(file).string(), rate = options.rate](
                   const ChildReport& report, int) { decode_video(report, path, rate); }) {}

  std::optional<Frame> next() override {
    while (!ended_) {
      const ChildMessage message = child_.receive();
      progress_ = std::max(progress_, static_cast<double>(message.offset) / 1e6);
      if (message.kind == ChildMessage::skipped) {
        warnings_.push_back(name_ + ": " + message.text);
      } else if (message.kind == ChildMessage::frame) {
        try {
          Frame frame = frame_from_bytes(message.text).frame;
          if (auto* image = std::get_if<ImageFrame>(&frame.content); image != nullptr && camera_)
            image->intrinsics = *camera_;
          frame.sensor = sensor_;
          return frame;
        } catch (const std::runtime_error& error) {
          end(error.what());
        }
      } else {
        end(message.kind == ChildMessage::end ? "" : message.text);
      }
    }
    return std::nullopt;
  }
  std::optional<std::string> damage() const override { return damage_; }
  std::vector<std::string> warnings() const override { return warnings_; }
  double progress() const override { return std::min(1.0, progress_); }

 private:
  static std::uint64_t file_size(const std::filesystem::path& file) {
    return InputFile(file, "video").size();
  }
  void end(const std::string& why) {
    ended_ = true;
    if (!why.empty()) damage_ = name_ + " is damaged: " + why;
  }

  std::string name_, sensor_;
  std::optional<CameraIntrinsics> camera_;
  DecodingChild child_;
  bool ended_ = false;
  double progress_ = 0.0;
  std::optional<std::string> damage_;
  std::vector<std::string> warnings_;
};

}  // namespace

bool is_video_file(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return false;
  const InputFile input(file, "recording");
  std::string head(12, '\0');
  if (::pread(input.descriptor(), head.data(), head.size(), 0) != static_cast<ssize_t>(head.size()))
    return false;
  const std::string_view bytes(head);
  return bytes.substr(4, 4) == "ftyp" || bytes.starts_with("\x1a\x45\xdf\xa3") ||
         (bytes.starts_with("RIFF") && bytes.substr(8) == "AVI ") || bytes.starts_with("OggS") ||
         bytes.starts_with(std::string_view("\0\0\1\xba", 4));
}

std::unique_ptr<FrameSource> open_video(const std::filesystem::path& file, const SourceOptions& options) {
  return std::make_unique<Video>(file, options);
}

}  // namespace clearway
