#include "datasets/depth_files/exr_file.hpp"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <gtest/gtest.h>

#include "mapping/system/input_file.hpp"
#include "tests/datasets/complaint.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace exr_file_test {

using Channels = std::vector<std::pair<const char*, std::vector<float>>>;

/// A picture of 3 x 2 pixels as OpenEXR's own writer makes it.
std::string exr(const Channels& channels, Imf::Compression compression = Imf::ZIP_COMPRESSION) {
  const TemporaryFolder folder;
  const std::string name = (folder / "depth.exr").string();
  {
    Imf::Header header(3, 2);
    header.compression() = compression;
    Imf::FrameBuffer buffer;
    for (const auto& [channel, values] : channels) {
      header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
      buffer.insert(channel,
                    Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(const_cast<float*>(values.data())),
                               sizeof(float), 3 * sizeof(float)));
    }
    Imf::OutputFile file(name.c_str(), header, 1);
    file.setFrameBuffer(buffer);
    file.writePixels(2);
  }
  return read_input(name, "picture", 1U << 20U);
}

const std::vector<float> depth{1.5F, 0.25F, 3.0F, 4.0F, 1e10F, 6.0F}, other{1, 2, 3, 4, 5, 6};

TEST(ExrFile, DepthIsTheChannelThatIsCalledSoOrTheOnlyOneOrThreeOfTheSame) {
  const std::vector<Channels> pictures{
      {{"Z", depth}},
      {{"Y", depth}},
      {{"R", depth}},
      {{"R", depth}, {"G", depth}, {"B", depth}},
      {{"R", depth}, {"G", depth}, {"B", depth}, {"A", other}},
      {{"R", other}, {"G", depth}, {"B", other}, {"Z", depth}},
      {{"ViewLayer.Combined.R", other}, {"ViewLayer.Combined.G", other}, {"ViewLayer.Depth.Z", depth}},
      {{"RenderLayer.Depth.V", depth}, {"RenderLayer.Mist.V", other}}};
  for (std::size_t i = 0; i < pictures.size(); ++i)
    for (const Imf::Compression compression : {Imf::NO_COMPRESSION, Imf::PIZ_COMPRESSION}) {
      const std::string bytes = exr(pictures[i], compression);
      EXPECT_TRUE(is_exr(bytes));
      const DepthPicture picture = decode_exr(bytes);
      EXPECT_EQ(picture.size, (ImageSize{3, 2})) << i;
      EXPECT_TRUE(picture.is_real) << i;
      EXPECT_EQ(picture.values, depth) << i;
    }
}

TEST(ExrFile, OthersAreRefusedInAClause) {
  const auto said = [](const std::string& bytes) {
    return complaint<std::runtime_error>([&] { decode_exr(bytes); });
  };
  EXPECT_NE(said(exr({{"R", depth}, {"G", other}, {"B", depth}})).find("holds colours"), std::string::npos);
  EXPECT_NE(said(exr({{"X", depth}, {"Y", other}})).find("2 channels, none of them"), std::string::npos);
  EXPECT_NE(said(exr({{"Z", depth}, {"left.Z", other}})).find("2 channels, 2 of them"), std::string::npos);
  const std::string whole = exr({{"Z", depth}});
  EXPECT_FALSE(is_exr("P5"));
  for (const char flag : {'\x08', '\x10'}) {  // deep, and of several parts
    std::string flagged = whole;
    flagged[5] = static_cast<char>(flagged[5] | flag);
    EXPECT_NE(said(flagged).find("several parts"), std::string::npos);
  }
  for (std::size_t size = 4; size < whole.size(); ++size) EXPECT_NE(said(whole.substr(0, size)), "") << size;
}

}  // namespace exr_file_test
}  // namespace clearway
