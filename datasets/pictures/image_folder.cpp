#include "datasets/pictures/image_folder.hpp"

#include <utility>

#include "datasets/pictures/files_in_child.hpp"
#include "datasets/pictures/picture_file.hpp"
#include "datasets/pictures/picture_times.hpp"
#include "datasets/sources/folder_damage.hpp"

namespace clearway {
namespace {

std::vector<std::filesystem::path> files_of(const TimedFiles& timed) {
  std::vector<std::filesystem::path> files;
  for (const TimedFile& file : timed.files) files.push_back(file.file);
  return files;
}

class ImageFolder final : public FrameSource {
 public:
  ImageFolder(TimedFiles timed, std::string sensor, const std::optional<CameraIntrinsics>& camera)
      : timed_(std::move(timed)),
        sensor_(std::move(sensor)),
        camera_(camera),
        files_(files_of(timed_), "picture", [](const std::string& bytes, std::size_t) {
          ImageFrame image;
          image.image = decode_picture(bytes);
          return image;
        }) {}

  std::optional<Frame> next() override {
    while (auto outcome = files_.next()) {
      const double time = timed_.files[at_++].time;
      if (!outcome->content) {
        damage_.note(outcome->refusal);
        continue;
      }
      auto& image = std::get<ImageFrame>(*outcome->content);
      if (camera_) image.intrinsics = *camera_;
      return Frame{time, sensor_, std::move(image), outcome->file.filename().string()};
    }
    return std::nullopt;
  }

  std::optional<std::string> damage() const override {
    return damage_.sentence(timed_.files.size(), "pictures");
  }
  std::vector<std::string> warnings() const override { return timed_.warnings; }
  std::string time_caveat() const override { return timed_.time_caveat; }
  double progress() const override {
    return static_cast<double>(at_) / static_cast<double>(timed_.files.size());
  }

 private:
  TimedFiles timed_;
  std::string sensor_;
  std::optional<CameraIntrinsics> camera_;
  FilesInChild files_;
  std::size_t at_ = 0;
  FolderDamage damage_;
};

}  // namespace

std::unique_ptr<FrameSource> open_pictures(const std::vector<std::filesystem::path>& files,
                                           const std::string& sensor, const SourceOptions& options) {
  return std::make_unique<ImageFolder>(times_of_files(files, options.rate), sensor, options.camera);
}

}  // namespace clearway
