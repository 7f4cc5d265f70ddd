#include "apps/overlay/video_file.hpp"

#include <dlfcn.h>
#include <unistd.h>

#include <cstddef>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <new>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/videoio.hpp>
#include <stdexcept>
#include <string>

#include "mapping/system/atomic_file.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

/// OpenCV's and FFmpeg's messages are not for people who ask for a video.
class QuietLibraries {
 public:
  QuietLibraries() : before_(cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT)) {
    ::setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
  }
  ~QuietLibraries() { cv::utils::logging::setLogLevel(before_); }
  QuietLibraries(const QuietLibraries&) = delete;
  QuietLibraries& operator=(const QuietLibraries&) = delete;

 private:
  cv::utils::logging::LogLevel before_;
};

/// OpenCV's video library is loaded when a video is written, as for reading one
/// (datasets/pictures/video.cpp): programs that only link it start 0.2 s later. Its constructor is looked up;
/// all else that is called is virtual.
class LoadedWriter {
 public:
  /// @throws std::runtime_error a clause that says why videos cannot be written
  LoadedWriter() {
    void* const library = ::dlopen(CLEARWAY_VIDEOIO, RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) throw std::runtime_error("OpenCV's library for videos is not installed");
    using Construct = void (*)(void*);
    const auto construct = reinterpret_cast<Construct>(::dlsym(library, "_ZN2cv11VideoWriterC1Ev"));
    if (construct == nullptr) throw std::runtime_error("OpenCV's library for videos is of another version");
    construct(memory_);
    writer_ = std::launder(reinterpret_cast<cv::VideoWriter*>(memory_));
  }
  ~LoadedWriter() { writer_->release(); }
  LoadedWriter(const LoadedWriter&) = delete;
  LoadedWriter& operator=(const LoadedWriter&) = delete;

  cv::VideoWriter* operator->() const { return writer_; }

 private:
  alignas(cv::VideoWriter) std::byte memory_[sizeof(cv::VideoWriter)];
  cv::VideoWriter* writer_ = nullptr;
};

constexpr int code_of(char a, char b, char c, char d) { return a | b << 8 | c << 16 | d << 24; }
constexpr int h264 = code_of('a', 'v', 'c', '1'), mpeg4 = code_of('m', 'p', '4', 'v');

/// A file that the encoder opens by its name and that then has none, so that it goes with this process.
class NamelessFile {
 public:
  NamelessFile() {
    std::string name = (std::filesystem::temp_directory_path() / "clearway-video-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr)
      throw std::runtime_error("no folder can be made in " + quote_path(name));
    folder_ = name;
  }
  ~NamelessFile() { remove_name(); }
  NamelessFile(const NamelessFile&) = delete;
  NamelessFile& operator=(const NamelessFile&) = delete;

  std::filesystem::path name() const { return folder_ / "video.mp4"; }

  /// Once the encoder has opened it.
  void take() {
    written_.open(name(), std::ios::binary);
    remove_name();
  }
  std::string read() { return {std::istreambuf_iterator<char>(written_), std::istreambuf_iterator<char>()}; }

 private:
  void remove_name() const {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  std::filesystem::path folder_;
  std::ifstream written_;
};

}  // namespace

struct VideoFile::State {
  QuietLibraries quiet{};
  NamelessFile file{};
  LoadedWriter writer{};
};

VideoFile::VideoFile(const std::filesystem::path& file, int width, int height, double rate)
    : file_(file), width_(width / 2 * 2), height_(height / 2 * 2) {
  const std::string name = quote_path(file.string());
  try {
    state_ = std::make_unique<State>();
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(name + ": no video can be written, " + error.what());
  }
  for (const int code : {h264, mpeg4}) {
    if (!state_->writer->open(state_->file.name().string(), code, rate, {width_, height_}, true)) continue;
    state_->file.take();
    return;
  }
  throw std::runtime_error(
      name + ": no video can be written, the system's OpenCV has no encoder for H.264 or MPEG-4");
}

VideoFile::~VideoFile() = default;

void VideoFile::add(const cv::Mat& picture) {
  state_->writer->write(picture(cv::Rect(0, 0, width_, height_)));
}

void VideoFile::finish() {
  state_->writer->release();
  const std::string bytes = state_->file.read();
  if (bytes.empty()) throw std::runtime_error(quote_path(file_.string()) + ": the encoder wrote nothing");
  save_file(file_, bytes);
}

}  // namespace clearway
