#include "oraclegs/capture/zip_photos.h"

#include <dlfcn.h>
#include <sys/statvfs.h>
#include <zip.h>

#include <atomic>
#include <map>

#include "image/jpeg_files.h"
#include "oraclegs/core/files.h"
#include "oraclegs/image/read_image.h"
#include "support/errors.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace {

std::atomic<int64_t> g_free_bytes = -1;  // of every disk, where it is not negative

}  // namespace

/// The system's, for std::filesystem::space.
extern "C" int statvfs(const char* path, struct statvfs* disk) noexcept {
  static auto* const system = reinterpret_cast<decltype(&statvfs)>(dlsym(RTLD_NEXT, "statvfs"));
  const int result = system(path, disk);
  if (g_free_bytes >= 0) disk->f_bavail = static_cast<fsblkcnt_t>(g_free_bytes) / disk->f_frsize;
  return result;
}

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
                               {".hidden.jpg", jpeg},
                               {"trip/3.jfif", jpeg},
                               {"trip/fake.jpg", "text"},
                               {"trip/cut.jpg", "\xFF\xD8\xFF and no more"}});
  EXPECT_TRUE(IsZip(dir / "a.zip"));
  EXPECT_EQ(CountZipPhotos(dir / "a.zip"), 6);
  EventRecorder events;
  UnpackPhotos(dir / "a.zip", dir / "out" / "in", events.AsListener());
  std::vector<std::string> found;
  for (const auto& entry : fs::recursive_directory_iterator(dir / "out")) {
    if (entry.is_regular_file()) found.push_back(entry.path().lexically_relative(dir / "out").string());
  }
  EXPECT_THAT(found, ::testing::UnorderedElementsAre("in/trip/1.jpg", "in/evil.jpg", "in/root.jpg", "in/trip/b_c.jpg",
                                                     "in/trip/3.jfif"));
  EXPECT_THAT(events.warnings,
              ::testing::UnorderedElementsAre(HasSubstr("trip/2.NEF: raw photos are not read"),
                                              HasSubstr("trip/masks/1.jpg: masks, depth maps and smaller copies"),
                                              HasSubstr("trip/fake.jpg: is no image, whatever its name says"),
                                              HasSubstr("trip/cut.jpg: is a damaged JPEG")));
}

TEST(UnpackPhotos, TakesTheOneFolderWhateverItIsCalled) {
  const TempDir dir;
  const std::string jpeg = EncodeJpeg(SmoothImage(16, 12, 3));
  WriteArchive(dir / "a.zip",
               {{"mask/1.jpg", jpeg}, {"mask/b/2.jpg", jpeg}, {"mask/depth/1.jpg", jpeg}, {"readme.txt", "x"}});
  EXPECT_EQ(CountZipPhotos(dir / "a.zip"), 2);
  UnpackPhotos(dir / "a.zip", dir / "out", Silent());
  EXPECT_TRUE(fs::exists(dir / "out/_mask/1.jpg"));
  EXPECT_TRUE(fs::exists(dir / "out/_mask/b/2.jpg"));
  WriteArchive(dir / "a.zip", {{"mask/1.jpg", jpeg}, {"photos/1.jpg", jpeg}});
  EXPECT_EQ(CountZipPhotos(dir / "a.zip"), 1);
}

TEST(UnpackPhotos, GivesPlacesOfTheirOwn) {
  const TempDir dir;
  const auto jpeg = [](int width) { return EncodeJpeg(SmoothImage(width, 12, 3)); };
  WriteArchive(dir / "a.zip", {{"a.jpg", jpeg(16)},
                               {"a.jpg/1.jpg", jpeg(17)},
                               {"/a-2.jpg", jpeg(18)},
                               {"b.jpg", jpeg(19)},
                               {"../b.jpg", jpeg(20)},
                               {"B.JPG", jpeg(21)}});
  EXPECT_EQ(CountZipPhotos(dir / "a.zip"), 6);
  UnpackPhotos(dir / "a.zip", dir / "out", [](const Event&) {});
  std::map<std::string, int> found;
  for (const auto& entry : fs::recursive_directory_iterator(dir / "out")) {
    if (!entry.is_regular_file()) continue;
    found[entry.path().lexically_relative(dir / "out").string()] = ReadImage(entry.path()).width;
  }
  using ::testing::Pair;
  EXPECT_THAT(found,
              ::testing::UnorderedElementsAre(Pair("a-2.jpg", 16), Pair("a.jpg/1.jpg", 17), Pair("a-2-2.jpg", 18),
                                              Pair("b.jpg", 19), Pair("b-2.jpg", 20), Pair("B-3.JPG", 21)))
      << "a folder keeps its name, a file gets another one, also where case does not count";
}

TEST(CountZipPhotos, CountsBeforeItNames) {
  const TempDir dir;
  std::vector<std::pair<std::string, std::string>> files;
  for (int i = 0; i < 30000; ++i) files.emplace_back(fmt::format("name{:05}.jpg", i), "x");
  WriteArchive(dir / "a.zip", files);
  std::string bytes = ReadFile(dir / "a.zip");  // libzip writes no equal names
  for (size_t at = 0; (at = bytes.find("name", at)) != std::string::npos; at += 4) bytes.replace(at + 4, 5, "00000");
  WriteText(dir / "a.zip", bytes);
  EXPECT_THAT(MessageOf<InputError>([&] { CountZipPhotos(dir / "a.zip"); }), HasSubstr("holds 30000 photos"));
}

TEST(CountZipPhotos, RefusesWhatUnpacksToMoreThanPhotosDo) {
  const TempDir dir;
  const std::string zeros(100'000'000, '\0');
  WriteArchive(dir / "zeros.zip", {{"a.jpg", zeros}});
  EXPECT_THAT(MessageOf<InputError>([&] { CountZipPhotos(dir / "zeros.zip"); }),
              HasSubstr("holds no photos (is no image, whatever its name says"));
  WriteArchive(dir / "bomb.zip", {{"a.jpg", "\xFF\xD8\xFF" + zeros}});
  const auto error = [&](auto&& action) { return MessageOf<InputError>(action); };
  EXPECT_THAT(error([&] { CountZipPhotos(dir / "bomb.zip"); }), HasSubstr("bomb.zip: unpacks to more than 0.1 GB"));
  EXPECT_THAT(error([&] { UnpackPhotos(dir / "bomb.zip", dir / "out", Silent()); }), HasSubstr("unpacks to more than"));
  EXPECT_FALSE(fs::exists(dir / "out"));
}

/// The archive, with another size of its files in all headers.
void PatchSizes(const fs::path& archive, uint32_t was, uint32_t is) {
  std::string bytes = ReadFile(archive);
  const auto text = [](uint32_t size) { return std::string(reinterpret_cast<const char*>(&size), 4); };
  for (size_t at = 0; (at = bytes.find(text(was), at)) != std::string::npos; at += 4) bytes.replace(at, 4, text(is));
  WriteText(archive, bytes);
}

TEST(UnpackPhotos, BelievesNoSize) {
  const TempDir dir;
  const std::string bomb = "\xFF\xD8\xFF" + std::string(100'000'000, '\0');
  WriteArchive(dir / "a.zip", {{"a.jpg", bomb}});
  PatchSizes(dir / "a.zip", static_cast<uint32_t>(bomb.size()), 1000);
  EXPECT_EQ(CountZipPhotos(dir / "a.zip"), 1);
  EXPECT_THROW(UnpackPhotos(dir / "a.zip", dir / "out", Silent()), InputError);
  EXPECT_TRUE(fs::is_empty(dir / "out"));
}

TEST(UnpackPhotos, RefusesAFullDiskBeforeItWrites) {
  const TempDir dir;
  const std::string jpeg = EncodeJpeg(SmoothImage(16, 12, 3)) + std::string(30'000'000, '\0');
  WriteArchive(dir / "a.zip", {{"1.jpg", jpeg}, {"2.jpg", jpeg}});
  g_free_bytes = 30'000'000;
  const std::string error = MessageOf<RunError>([&] { UnpackPhotos(dir / "a.zip", dir / "out", Silent()); });
  g_free_bytes = 200'000'000;
  UnpackPhotos(dir / "a.zip", dir / "room", Silent());
  g_free_bytes = -1;
  EXPECT_THAT(error, HasSubstr("out: the photos take 0.1 GB, and 0.0 GB are free; make room there"));
  EXPECT_TRUE(fs::is_empty(dir / "out"));
  EXPECT_TRUE(fs::exists(dir / "room" / "2.jpg"));
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
