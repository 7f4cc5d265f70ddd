#include "mapping/files/map_digest.hpp"

#include <gtest/gtest.h>

#include "mapping/files/map_file.hpp"
#include "mapping/free_space_map.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace map_digest_test {

TEST(MapDigest, sha256_of_known_texts) {  // FIPS 180-2, appendix B
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(MapDigest, of_a_file_is_that_of_its_bytes) {
  const TemporaryFolder folder;
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{3}, std::size_t{1} << 20U, std::size_t{2500000}}) {
    std::string bytes(size, 'a');
    for (std::size_t i = 0; i < size; i += 7) bytes[i] = static_cast<char>(i / 7);
    folder.write("f", bytes);
    EXPECT_EQ(file_sha256(folder / "f"), sha256(bytes)) << size;
  }
  EXPECT_THROW(file_sha256(folder / "none"), std::runtime_error);
}

TEST(MapDigest, is_that_of_the_file_which_the_map_is_saved_as) {
  const TemporaryFolder folder;
  FreeSpaceMap map({.resolution = 0.05});
  const int volume = map.add_volume("free", {"tool"});
  map.paint(volume, {{0.1, 0.2, 0.3}, 0.4});
  const std::string before = map_sha256(map.snapshot());
  map.paint(volume, {{0.6, 0.2, 0.3}, 0.4});
  const Snapshot snapshot = map.snapshot();
  save_map(snapshot, folder.path());
  EXPECT_EQ(map_sha256(snapshot), map_sha256(folder.path()));
  EXPECT_NE(map_sha256(snapshot), before);
}

}  // namespace map_digest_test
}  // namespace clearway
