#include "apps/fusion/open_frames.hpp"

#include <stdexcept>

#include "apps/console/parse.hpp"
#include "apps/fusion/cloud_folder.hpp"
#include "apps/fusion/velodyne_folder.hpp"
#include "datasets/bags/bag_metadata.hpp"
#include "datasets/bags/bag_source.hpp"
#include "datasets/bags/sens_file.hpp"
#include "datasets/bags/unread_recordings.hpp"
#include "datasets/camera_files/camera_file.hpp"
#include "datasets/cameras/off_centre.hpp"
#include "datasets/pictures/depth_folder.hpp"
#include "datasets/pictures/depth_picture.hpp"
#include "datasets/pictures/image_folder.hpp"
#include "datasets/pictures/picture_file.hpp"
#include "datasets/pictures/picture_times.hpp"
#include "datasets/pictures/video.hpp"
#include "datasets/sources/scan_graph.hpp"
#include "mapping/files/cloud_file.hpp"
#include "mapping/files/velodyne_scan.hpp"
#include "mapping/files/xyz_file.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

class Rawlog final : public FrameSource {
 public:
  explicit Rawlog(const fs::path& file) : reader_(file) {}
  std::optional<Frame> next() override { return reader_.next(); }
  std::optional<std::string> damage() const override { return reader_.damage(); }
  std::vector<std::string> warnings() const override { return reader_.warnings(); }
  double progress() const override { return reader_.progress(); }

 private:
  RecordingReader reader_;
};

/// A source of whose options there is something to tell.
class NotedSource final : public FrameSource {
 public:
  NotedSource(std::unique_ptr<FrameSource> source, std::vector<std::string> notes)
      : source_(std::move(source)), notes_(std::move(notes)) {}
  std::optional<Frame> next() override { return source_->next(); }
  std::optional<std::string> damage() const override { return source_->damage(); }
  std::vector<std::string> warnings() const override {
    std::vector<std::string> sentences = notes_;
    for (const std::string& warning : source_->warnings()) sentences.push_back(warning);
    return sentences;
  }
  std::string time_caveat() const override { return source_->time_caveat(); }
  std::vector<TakenCamera> cameras() const override { return source_->cameras(); }
  double progress() const override { return source_->progress(); }
  bool is_live() const override { return source_->is_live(); }

 private:
  std::unique_ptr<FrameSource> source_;
  std::vector<std::string> notes_;
};

std::unique_ptr<FrameSource> noted(std::unique_ptr<FrameSource> source, std::string note) {
  return std::make_unique<NotedSource>(std::move(source), std::vector<std::string>{std::move(note)});
}

/// A text says nothing of where it was seen from.
bool is_posed_cloud(const fs::path& file) {
  return is_cloud_file(file) && !is_velodyne_file(file) && !is_xyz_file(file);
}

/// A sentence on files of a folder that are left out, as others are its frames.
std::string of_another_kind(const std::vector<fs::path>& others, const std::vector<fs::path>& frames) {
  return counted(others.size(), "more file") + " in the folder, such as " +
         quote_path(others.front().filename().string()) + ", " + (others.size() == 1 ? "is" : "are") +
         " not read: another kind than " + quote_path(frames.front().filename().string()) + ".";
}

/// Points alone, without a viewpoint.
bool is_bare_cloud(const fs::path& file) { return is_velodyne_file(file) || is_xyz_file(file); }

/// What is called like a file that `is_wanted`. One that is no file, or a link to none, is reported as
/// damage: what it should hold is missing.
std::vector<fs::path> files_in(const fs::path& folder, bool (*is_wanted)(const fs::path&)) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (is_wanted(entry.path())) files.push_back(entry.path());
  return files;
}

/// The camera that TUM's own tools take for its depth pictures, which are registered to the colour pictures.
SourceOptions with_camera_of_tum(const DepthLayout& layout, SourceOptions options) {
  DepthOptions& depth = options.depth;
  constexpr ImageSize size{640, 480};
  if (picture_size(layout.depth.front()) != size ||
      !is_of_tum(depth.poses.empty() ? layout.poses : depth.poses))
    return options;
  depth.camera = CameraIntrinsics{size.width, size.height, 525.0, 525.0, 319.5, 239.5, {}};
  options.notes.push_back(
      "the depth pictures' camera is taken as TUM's tools take it, fx = fy = 525, cx = 319.5, cy = 239.5; "
      "`source: {depth: {camera: …}}` states another.");
  return options;
}

/// The camera that TartanAir publishes, a view of 90 degrees across.
SourceOptions with_camera_of_tartanair(const DepthLayout& layout, SourceOptions options) {
  const auto head = depth_picture_head(in_order_of_names(layout.depth));
  if (!head || (head->size != ImageSize{640, 480} && head->size != ImageSize{640, 640})) return options;
  const double middle = 0.5 * head->size.height;
  options.depth.camera =
      CameraIntrinsics{head->size.width, head->size.height, 320.0, 320.0, 320.0, middle, {}};
  options.notes.push_back(
      "the depth pictures' camera is taken as TartanAir publishes it, fx = fy = 320, cx = 320, cy = " +
      short_text(middle) + "; `source: {depth: {camera: …}}` states another.");
  return options;
}

/// Where the setup says nothing of a camera: that of a file in the folder.
SourceOptions with_camera_beside(const DepthLayout& layout, SourceOptions options) {
  DepthOptions& depth = options.depth;
  if (depth.camera || options.camera) return options;
  if (layout.camera.empty())
    return layout.of_tartanair ? with_camera_of_tartanair(layout, options)
                               : with_camera_of_tum(layout, options);
  if (layout.camera.filename() == "camera_matrix.csv") return options;  // open_depth_folder knows its size
  std::optional<ImageSize> size;
  if (const auto head = depth_picture_head(in_order_of_names(layout.depth))) size = head->size;
  std::string note;
  depth.camera = load_camera_file(layout.camera, "", depth.rectified, size, {}, &note);
  depth.camera_file = layout.camera;
  if (!note.empty()) options.notes.push_back(note + ".");
  if (!is_off_centre(*depth.camera)) return options;
  try {
    load_camera_file(layout.camera, "", depth.rectified);
  } catch (const std::invalid_argument&) {  // it does not say the size itself
    throw std::invalid_argument(
        "camera file " + quote_path(layout.camera.string()) + " " + off_centre_clause(*depth.camera) +
        ": expected the matrix of these pictures, or, if they are a part of larger ones, `source: {depth: "
        "{camera: {file: …, width: …, height: …}}}` in the setup with their size");
  }
  return options;
}

/// What the file of the depth pictures' camera says of their scale: the setup's, or the one in the folder
/// that is in use. Replica's and those of BundleFusion say it of the folder, whatever camera is.
SourceOptions with_scale_of_file(const DepthLayout& layout, SourceOptions options) {
  DepthOptions& depth = options.depth;
  if (depth.scale) return options;
  const fs::path name = layout.camera.filename();
  const bool is_of_folder = name == "cam_params.json" || name == "info.txt" || name == "_info.txt";
  const bool is_in_use = !layout.camera.empty() && depth.camera_file == layout.camera;
  for (const auto& [file, camera] :
       {std::pair{depth.scale_file, depth.scale_camera},
        std::pair{is_of_folder || is_in_use ? layout.camera : fs::path(), std::string()}}) {
    if (depth.scale_of_file || file.empty()) continue;
    try {
      depth.scale_of_file = depth_scale_of_file(file, camera);
    } catch (const std::invalid_argument& error) {
      depth.scale_note = error.what();
    }
    if (depth.scale_of_file)
      depth.scale_note = "steps of depth are " + short_text(*depth.scale_of_file) + " m, by " +
                         quote_path(file.string()) + "; `source: {depth: {scale: …}}` states others.";
  }
  return options;
}

/// What is to be told of a source with these options.
std::vector<std::string> notes_of(const SourceOptions& options) {
  std::vector<std::string> notes = options.notes;
  for (const auto& camera : {options.camera, options.depth.camera})
    if (camera && is_off_centre(*camera))
      notes.push_back("the setup's camera " + off_centre_clause(*camera) +
                      ": right of a part of larger pictures alone.");
  return notes;
}

bool is_usual(const fs::path& file) {
  const std::string end = extension_of(file);
  return end == ".png" || end == ".jpg" || end == ".jpeg";
}

bool is_pgm(const fs::path& file) { return extension_of(file) == ".pgm"; }

/// The pictures of EuRoC's first camera in the folder of a sequence, of its mav0 or of cam0; empty: none.
fs::path euroc_pictures(const fs::path& folder) {
  std::error_code error;
  for (const char* camera : {"mav0/cam0", "cam0", "."}) {
    const fs::path place = (folder / camera).lexically_normal();
    if (fs::is_directory(place / "data", error) && fs::exists(place / "data.csv", error) &&
        !files_in(place / "data", is_picture_file).empty())
      return place / "data";
  }
  return {};
}

std::unique_ptr<FrameSource> open_noted_depth(const fs::path& folder, const DepthLayout& depth,
                                              const SourceOptions& options) {
  const SourceOptions whole = with_scale_of_file(depth, with_camera_beside(depth, options));
  std::vector<std::string> notes(whole.notes.begin() + static_cast<std::ptrdiff_t>(options.notes.size()),
                                 whole.notes.end());
  if (!depth.arrays.empty()) notes.push_back(of_another_kind(depth.arrays, depth.depth));
  auto source = open_depth_folder(folder, depth, whole);
  if (notes.empty()) return source;
  return std::make_unique<NotedSource>(std::move(source), notes);
}

/// What a folder holds beside depth.
struct FolderContent {
  std::string name;
  std::vector<fs::path> pictures, clouds;
  std::optional<VelodyneLayout> velodyne;
};

/// Null where there is nothing of these.
std::unique_ptr<FrameSource> open_other(const fs::path& folder, const FolderContent& content,
                                        const SourceOptions& options) {
  std::error_code error;
  const auto& [name, pictures, clouds, velodyne] = content;
  if (!pictures.empty() && !clouds.empty())
    throw std::invalid_argument("recording " + quote_path(folder.string()) + " has " +
                                counted(pictures.size(), "picture") + " and " +
                                counted(clouds.size(), "cloud") + "; expected a folder of one kind");
  if (!pictures.empty()) return open_pictures(pictures, name, options);
  if (!clouds.empty()) {
    auto source = open_clouds(clouds, scan_poses_beside(folder), name, options);
    const std::vector<fs::path> others = files_in(folder, is_bare_cloud);
    if (others.empty()) return source;
    return noted(std::move(source), of_another_kind(others, clouds));
  }
  if (velodyne) return open_velodyne(*velodyne, name, options);
  if (const fs::path data = euroc_pictures(folder); !data.empty())
    return noted(open_pictures(files_in(data, is_picture_file), name, options),
                 "the pictures are those in " + quote_path(data.string()) + ".");
  if (const std::vector<fs::path> grey = files_in(folder, is_pgm); !grey.empty())
    return open_pictures(grey, name, options);
  if (const fs::path rgb = folder / "rgb"; fs::is_directory(rgb, error))
    if (const std::vector<fs::path> colour = files_in(rgb, is_picture_file); !colour.empty())
      return noted(open_pictures(colour, name, options),
                   "the pictures are those in " + quote_path(rgb.string()) + ".");
  return nullptr;
}

/// The folder of scans of KITTI's raw data, in that of a drive or in its velodyne_points; empty: none.
fs::path scans_within(const fs::path& folder) {
  try {
    for (const char* inner : {"data", "velodyne_points/data"})
      if (velodyne_layout(folder / inner)) return (folder / inner).lexically_normal();
  } catch (const fs::filesystem_error&) {  // it cannot be read
  }
  return {};
}

/// Refuses with what it is that others write, else with what it is not.
[[noreturn]] void refuse_unread(const fs::path& recording, const std::string& otherwise) {
  const std::string unread = unread_recording(recording);
  throw std::invalid_argument("recording " + quote_path(recording.string()) + " " +
                              (unread.empty() ? otherwise + "; expected " + kinds_of_recordings : unread));
}

std::unique_ptr<FrameSource> open_folder(const fs::path& folder, const SourceOptions& options) {
  std::error_code error;
  const std::string name = fs::weakly_canonical(folder, error).filename().string();
  std::vector<fs::path> pictures, clouds;
  std::optional<DepthLayout> depth;
  std::optional<VelodyneLayout> velodyne;
  try {
    depth = depth_layout(folder, options.depth.poses);
    pictures = files_in(folder, is_picture_file);
    clouds = files_in(folder, is_posed_cloud);
    velodyne = velodyne_layout(folder);
    // Beside clouds the less usual formats are views of them.
    if (!clouds.empty() || velodyne)
      std::erase_if(pictures, [](const fs::path& file) { return !is_usual(file); });
    if (std::any_of(pictures.begin(), pictures.end(), is_usual))
      std::erase_if(pictures, [](const fs::path& file) { return !is_usual(file); });
  } catch (const fs::filesystem_error& failure) {
    throw std::invalid_argument("recording " + quote_path(folder.string()) +
                                " cannot be read: " + failure.code().message());
  }
  // Arrays that nothing places are what somebody made of what lies beside them.
  const bool is_derived = depth && depth->poses.empty() && depth->pose_folder.empty() &&
                          options.depth.poses.empty() && !options.places_depth &&
                          is_depth_array(depth->depth.front());
  if (depth && !is_derived) return open_noted_depth(folder, *depth, options);
  if (auto source = open_other(folder, {name, pictures, clouds, velodyne}, options)) {
    if (!depth) return source;
    return noted(std::move(source), "depth in arrays, such as " + quote_path(depth->depth.front().string()) +
                                        ", is left out: nothing says where it was taken from.");
  }
  if (depth) return open_noted_depth(folder, *depth, options);  // says what is missing
  if (const fs::path session = folder / "session"; fs::exists(session / "session.json", error))
    throw std::invalid_argument("recording " + quote_path(folder.string()) +
                                " is what `teach` wrote: expected its session, " +
                                quote_path(session.string()));
  if (const fs::path scans = scans_within(folder); !scans.empty())
    throw std::invalid_argument("recording " + quote_path(folder.string()) +
                                " has its scans in a folder within: expected " + quote_path(scans.string()));
  refuse_unread(folder, "is a folder without pictures and clouds");
}

/// Poses that have no times are of a folder of KITTI's scans, by their numbers.
void require_scans_of_kitti(const fs::path& recording, const SourceOptions& options) {
  if (options.numbered_poses.empty()) return;
  try {
    if (velodyne_layout(recording)) return;
  } catch (const fs::filesystem_error&) {  // not a folder
  }
  throw std::invalid_argument("poses " + quote_path(options.numbered_poses.string()) +
                              " have no times, as lines of 12 numbers are KITTI's, and recording " +
                              quote_path(recording.string()) +
                              " is no folder of KITTI's scans; expected lines 'time x y z qx qy qz qw'");
}

/// As bags whose recorder packs whole files, beside their metadata.yaml.
bool has_packed_files(const fs::path& folder) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (const std::string kind = extension_of(entry.path()); kind == ".zstd" || kind == ".zst") return true;
  return false;
}

std::unique_ptr<FrameSource> open_any(const fs::path& recording, const SourceOptions& options) {
  std::error_code error;
  require_scans_of_kitti(recording, options);
  if (is_bag_folder(recording) || has_packed_files(recording)) require_unpacked(recording);
  if (is_bag_folder(recording)) {
    SourceOptions of_bag = options;
    of_bag.bag.parts = listed_parts(recording);
    return open_bag(recording, of_bag);
  }
  if (fs::is_directory(recording, error)) return open_folder(recording, options);
  if (is_camera_name(recording)) return open_camera(recording, options);
  const bool is_file = fs::is_regular_file(recording, error);
  if (is_file && is_cloud_file(recording) && !is_xyz_file(recording)) {
    require_input(recording, "recording");
    if (is_velodyne_file(recording))
      return open_velodyne({{recording}, {}, {}, {}}, recording.stem().string(), options);
    return open_clouds({recording}, {}, recording.stem().string(), options);
  }
  if (is_file && is_picture_file(recording))
    return open_pictures({recording}, recording.stem().string(), options);
  if (is_file && is_bag_file(recording)) return open_bag(recording, options);
  if (is_file && is_video_file(recording)) {
    const std::string unread = unread_depth_of(recording);
    auto video = open_video(recording, options);
    return unread.empty() ? std::move(video) : noted(std::move(video), unread);
  }
  if (is_file && is_sens_file(recording)) return open_sens(recording, options);
  if (is_scan_graph(recording)) return open_scan_graph(recording, options);
  const std::string kind = extension_of(recording);
  if (!is_file || kind.empty() || kind == ".rawlog" || kind == ".gz")
    return std::make_unique<Rawlog>(recording);
  try {
    return std::make_unique<Rawlog>(recording);
  } catch (const std::invalid_argument&) {
    refuse_unread(recording, "is of no kind that is read here");
  }
}

/// Rendered pictures are what their setup says: errors that it does not state are none, but for what the
/// detector makes of sharp edges.
void take_as_rendered(Setup& setup) {
  CameraErrorsSetup& camera = setup.errors.camera;
  for (std::optional<double>* error : {&camera.focal, &camera.aspect, &camera.center, &camera.distortion})
    *error = error->value_or(0.0);
  for (BoardSetup& board : setup.boards)
    for (std::optional<double>* error :
         {&board.errors.scale, &board.errors.size, &board.errors.place, &board.errors.turn})
      *error = error->value_or(0.0);
  constexpr double edge_px = 0.05;
  setup.errors.edge = setup.errors.edge.value_or(edge_px);
}

}  // namespace

std::unique_ptr<FrameSource> open_frames(const fs::path& recording, const SourceOptions& options) {
  auto source = open_any(recording, options);
  const std::vector<std::string> notes = notes_of(options);
  if (notes.empty()) return source;
  return std::make_unique<NotedSource>(std::move(source), notes);
}

ChosenSetup choose_setup(const fs::path& recording, const fs::path& setup_file) {
  if (!setup_file.empty()) return {load_setup(setup_file), setup_file.string()};
  if (is_camera_name(recording)) throw std::invalid_argument("a camera has no setup; expected --setup");
  const std::optional<Frame> first = open_frames(recording, {})->next();
  if (!first) return {};
  const auto* comment = std::get_if<CommentFrame>(&first->content);
  if (comment == nullptr) return {};
  Setup setup = parse_setup(comment->text, recording.string() + " (embedded setup)");
  take_as_rendered(setup);
  return {std::move(setup), "embedded in the recording"};
}

}  // namespace clearway
