#include "oraclegs/capture/zip_photos.h"

#include <zip.h>

#include <map>

#include "image/jpeg_files.h"
#include "oraclegs/core/files.h"
#include "support/errors.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

void WriteArchive(const fs::path& path, const std::vector<std::pair<std::string, std::string>>& files) {
  int code = 0;
  zip_t* zip = zip_open(path.c_str(), ZIP_CREATE | ZIP_TRUNCATE, &code);
  for (const auto& [name, bytes] : files) {
    zip_file_add(zip, name.c_str(), zip_source_buffer(zip, bytes.data(), bytes.size(), 0), ZIP_FL_ENC_UTF_8);
  }
  ASSERT_EQ(zip_close(zip), 0);
}

TEST(UnpackPhotos, TakesPhotosOnlyAndStaysInside) {
  const TempDir dir;
  const std::string jpeg = EncodeJpeg(SmoothImage(16, 12, 3));
  WriteArchive(dir / "a.zip", {{"trip/1.jpg", jpeg},
                               {"../../evil.jpg", jpeg},
                               {"/root.jpg", jpeg},
                               {"__MACOSX/._1.jpg", "x"},
                               {"notes.txt", "x"},
                               {"trip/2.NEF", "x"},
                               {"trip/masks/1.jpg", jpeg},
                               {"trip/b\\c.jpg", jpeg},
                               {".hidden.jpg", jpeg}});
  EXPECT_TRUE(IsZip(dir / "a.zip"));
  EXPECT_EQ(CountZipPhotos(dir / "a.zip"), 4);
  EventRecorder events;
  UnpackPhotos(dir / "a.zip", dir / "out" / "in", events.AsListener());
  std::vector<std::string> found;
  for (const auto& entry : fs::recursive_directory_iterator(dir / "out")) {
    if (entry.is_regular_file()) found.push_back(entry.path().lexically_relative(dir / "out").string());
  }
  EXPECT_THAT(found, ::testing::UnorderedElementsAre("in/trip/1.jpg", "in/evil.jpg", "in/root.jpg", "in/trip/b_c.jpg"));
  EXPECT_THAT(events.warnings,
              ::testing::UnorderedElementsAre(HasSubstr("trip/2.NEF: raw photos are not read"),
                                              HasSubstr("trip/masks/1.jpg: masks and smaller copies are not taken")));
}

TEST(UnpackPhotos, GivesPlacesOfTheirOwn) {
  const TempDir dir;
  WriteArchive(dir / "a.zip",
               {{"a.jpg", "file"}, {"a.jpg/1.jpg", "below"}, {"/a-2.jpg", "taken"}, {"b.jpg", "1"}, {"../b.jpg", "2"}});
  EXPECT_EQ(CountZipPhotos(dir / "a.zip"), 5);
  UnpackPhotos(dir / "a.zip", dir / "out", [](const Event&) {});
  std::map<std::string, std::string> found;
  for (const auto& entry : fs::recursive_directory_iterator(dir / "out")) {
    if (!entry.is_regular_file()) continue;
    found[entry.path().lexically_relative(dir / "out").string()] = ReadFile(entry.path());
  }
  EXPECT_THAT(found, ::testing::UnorderedElementsAre(::testing::Pair("a-2.jpg", "file"),
                                                     ::testing::Pair("a.jpg/1.jpg", "below"),
                                                     ::testing::Pair("a-2-2.jpg", "taken"),
                                                     ::testing::Pair("b.jpg", "1"), ::testing::Pair("b-2.jpg", "2")))
      << "a folder keeps its name, a file gets another one";
}

TEST(CountZipPhotos, NamesWhatIsWrong) {
  const TempDir dir;
  WriteArchive(dir / "none.zip", {{"notes.txt", "x"}});
  EXPECT_THAT(MessageOf<InputError>([&] { CountZipPhotos(dir / "none.zip"); }), HasSubstr("none.zip: holds no photos"));
  WriteText(dir / "cut.zip", "PK\3\4 and no more");
  EXPECT_THAT(MessageOf<InputError>([&] { CountZipPhotos(dir / "cut.zip"); }), HasSubstr("cut.zip: is a damaged"));
  std::vector<std::pair<std::string, std::string>> many;
  for (int i = 0; i < 501; ++i) many.emplace_back(fmt::format("{}.jpg", i), "x");
  WriteArchive(dir / "many.zip", many);
  EXPECT_THAT(MessageOf<InputError>([&] { CountZipPhotos(dir / "many.zip"); }), HasSubstr("holds 501 photos"));
}

}  // namespace
}  // namespace oraclegs
