#include "datasets/bags/unread_recordings.hpp"

#include <algorithm>
#include <array>

#include "mapping/system/input_file.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

struct UnreadKind {
  const char* end;   ///< of the name
  const char* what;  ///< it is, and the way out
};

constexpr std::array unread_kinds{
    UnreadKind{".bz2", "is packed: expected an unpacked file (`bunzip2`)"},
    UnreadKind{".zst", "is packed: expected an unpacked file (`zstd -d`)"},
    UnreadKind{".zstd", "is packed: expected an unpacked file (`zstd -d`)"},
    UnreadKind{".lz4", "is packed: expected an unpacked file (`lz4 -d`)"},
    UnreadKind{".xz", "is packed: expected an unpacked file (`unxz`)"},
    UnreadKind{".zip", "is an archive: expected the folder that is in it (`unzip`)"},
    UnreadKind{".tar", "is an archive: expected the folder that is in it (`tar -x`)"},
    UnreadKind{".tgz", "is an archive: expected the folder that is in it (`tar -xz`)"},
    UnreadKind{
        ".r3d",
        "is Record3D's, whose depth is packed by LZFSE: expected the folder EXR_RGBD/ that its export as "
        "EXR and JPG writes"},
    UnreadKind{
        ".svo",
        "is ZED's: expected a folder depth/ of 16-bit PNG and poses as TUM text, or a bag, which ZED's "
        "tools write"},
    UnreadKind{
        ".svo2",
        "is ZED's: expected a folder depth/ of 16-bit PNG and poses as TUM text, or a bag, which ZED's "
        "tools write"},
    UnreadKind{".oni", "is OpenNI's: expected a folder depth/ of 16-bit PNG and poses as TUM text"},
    UnreadKind{".klg", "is Logger2's: expected a folder depth/ of 16-bit PNG and poses as TUM text"},
    UnreadKind{".vrs", "is Project Aria's: expected a folder depth/ of 16-bit PNG and poses as TUM text"},
    UnreadKind{".npz", "is an archive of arrays: expected a folder depth/ of .npy files and poses.npy"},
    UnreadKind{".h5",
               "is of HDF5: expected a folder depth/ of .npy or 16-bit PNG files and poses as TUM text"},
    UnreadKind{".hdf5",
               "is of HDF5: expected a folder depth/ of .npy or 16-bit PNG files and poses as TUM text"}};

/// Whether the folder has a file with this end of its name.
bool has_kind(const fs::path& folder, const char* end) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (extension_of(entry.path()) == end) return true;
  return false;
}

std::string unread_folder(const fs::path& folder) {
  std::error_code error;
  for (const fs::path& place : {folder, folder / "rgbd"})
    if (has_kind(place, ".depth"))
      return "has Record3D's depth, which is packed by LZFSE: expected the folder EXR_RGBD/ that its export "
             "as "
             "EXR and JPG writes";
  for (const fs::path& place : {folder, folder / "iphone"})
    if (fs::exists(place / "depth.bin", error) && fs::exists(place / "pose_intrinsic_imu.json", error))
      return "has ScanNet++'s depth, which is packed in depth.bin: expected the folder depth/ of PNG beside "
             "it "
             "that ScanNet++'s prepare_iphone_data writes";
  return "";
}

}  // namespace

std::string unread_recording(const fs::path& recording) {
  std::error_code error;
  if (fs::is_directory(recording, error)) return unread_folder(recording);
  const std::string end = extension_of(recording);
  const auto kind = std::find_if(unread_kinds.begin(), unread_kinds.end(),
                                 [&](const UnreadKind& known) { return end == known.end; });
  return kind == unread_kinds.end() ? "" : kind->what;
}

std::string unread_depth_of(const fs::path& video) {
  constexpr std::size_t reach = 1U << 20U;  // bytes, within which k4arecorder has its tags
  if (extension_of(video) != ".mkv") return "";
  std::string head;
  InputFile(video, "recording").read_at(0, reach, head);
  return head.find("K4A_DEPTH_MODE") == std::string::npos
             ? ""
             : "the video is an Azure Kinect's, of which only colours are read; Open3D's "
               "azure_kinect_mkv_reader writes a folder with its depth.";
}

}  // namespace clearway
