#include "oraclegs/app/uploads.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

namespace fs = std::filesystem;

const std::string kJpeg = "\xff\xd8\xff\xe0 something like a JPEG of some length";

class UploadsTest : public testing::Test {
 protected:
  UploadsTest() { fs::create_directories(paths.root()); }

  /// Sends `bytes`, of which only `sent` arrive.
  Upload Send(const std::string& name, const std::string& bytes, size_t sent = SIZE_MAX) {
    WebRequest request{"POST", "/api/projects/ID/upload", "127.0.0.1:7860"};
    request.content_length = bytes.size();
    request.read = [&, at = size_t{0}](char* to, size_t count) mutable -> ptrdiff_t {
      const size_t n = std::min({count, std::min(sent, bytes.size()) - at, size_t{1000}});
      std::memcpy(to, bytes.data() + at, n);
      at += n;
      read = at;
      return static_cast<ptrdiff_t>(n);
    };
    return ReceiveUpload(paths, name, request, limits);
  }
  int StatusOf(const std::string& name, const std::string& bytes, size_t sent = SIZE_MAX) {
    try {
      Send(name, bytes, sent);
      return 201;
    } catch (const UploadRefusal& refusal) {
      EXPECT_FALSE(refusal.reason.empty());
      return refusal.status;
    }
  }
  std::vector<std::string> Names() const {
    std::vector<std::string> names;
    for (const Upload& upload : UploadsOf(paths)) names.push_back(upload.path.filename().string());
    return names;
  }

  TempDir dir;
  ProjectPaths paths{dir / "project"};
  UploadLimits limits{.keep_free = 0};
  size_t read = 0;
};

TEST_F(UploadsTest, AreSortedByWhatTheyHold) {
  const Upload photo = Send("IMG_10.jpg", kJpeg);
  EXPECT_EQ(photo.kind, UploadKind::kPhoto);
  EXPECT_EQ(ReadFile(photo.path), kJpeg);
  Send("IMG_2.jpg", kJpeg);
  EXPECT_EQ(Send("walk.mp4", std::string("\0\0\0\x18", 4) + "ftypmp42 and so on").kind, UploadKind::kVideo);
  EXPECT_EQ(Send("all.zip", "PK\x03\x04 and so on").kind, UploadKind::kZip);
  EXPECT_THAT(Names(), testing::ElementsAre("IMG_2.jpg", "IMG_10.jpg", "all.zip", "walk.mp4"));
  EXPECT_EQ(UploadsOf(paths)[1].id, photo.id);
  EXPECT_EQ(UploadsOf(paths)[2].kind, UploadKind::kZip);
}

TEST_F(UploadsTest, OfOneNameBothStay) {
  Send("a.jpg", kJpeg);
  Send("a.jpg", kJpeg + "2");
  EXPECT_THAT(Names(), testing::UnorderedElementsAre("a.jpg", "a (2).jpg"));
}

TEST_F(UploadsTest, NamesLeadNowhereElse) {
  for (const char* name :
       {"../../evil.jpg", "/etc/evil.jpg", "..\\evil.jpg", ".evil.jpg", "a/b/evil.jpg", "...evil.jpg"}) {
    const Upload upload = Send(name, kJpeg);
    EXPECT_EQ(upload.path.parent_path(), paths.photos()) << name;
    EXPECT_THAT(upload.path.filename().string(), testing::StartsWith("evil")) << name;
  }
  EXPECT_EQ(Send("", kJpeg).path.filename(), "photo");
  EXPECT_EQ(Send("..", kJpeg).path.filename(), "photo (2)");
  EXPECT_EQ(Send("a\nb.jpg", kJpeg).path.filename(), "a_b.jpg");
  EXPECT_EQ(Send(std::string(400, 'x') + ".jpg", kJpeg).path.filename().string().size(), 150u);
  std::string umlauts;
  for (int i = 0; i < 200; ++i) umlauts += "ä";
  EXPECT_TRUE(IsUtf8(Send(umlauts + ".jpg", kJpeg).path.filename().string()));
  EXPECT_EQ(Send("\xff.jpg", kJpeg).path.filename(), "_xFF.jpg");
}

TEST_F(UploadsTest, WhatIsNoPhotoIsRefusedWithItsReason) {
  EXPECT_EQ(StatusOf("a.jpg", "this is a text"), 415);
  EXPECT_EQ(StatusOf("a.cr2", kJpeg), 415) << "a raw photo";
  EXPECT_EQ(StatusOf("a.jpg", ""), 400);
  EXPECT_THAT(Names(), IsEmpty());
  EXPECT_TRUE(fs::is_empty(paths.photos()));
}

TEST_F(UploadsTest, HalfAFileIsNone) {
  EXPECT_EQ(StatusOf("a.jpg", kJpeg, 10), 400);
  EXPECT_TRUE(fs::is_empty(paths.photos()));
}

TEST_F(UploadsTest, LimitsHold) {
  limits.photo_bytes = kJpeg.size();
  EXPECT_EQ(StatusOf("a.jpg", kJpeg), 201);
  EXPECT_EQ(StatusOf("b.jpg", kJpeg + "+"), 413);
  limits.media_bytes = 1000;
  EXPECT_EQ(StatusOf("c.jpg", kJpeg + std::string(2000, 'x')), 413);
  limits.files = 1;
  EXPECT_EQ(StatusOf("d.jpg", kJpeg), 413);
  EXPECT_EQ(read, kJpeg.size()) << "the rest is read, or the browser would not see why";
  limits = {.keep_free = uint64_t{1} << 62};
  EXPECT_EQ(StatusOf("e.jpg", kJpeg), 507);
  WebRequest endless{"POST", "/", "127.0.0.1:7860"};
  EXPECT_THROW(ReceiveUpload(paths, "f.jpg", endless, limits), UploadRefusal);
  EXPECT_THAT(Names(), SizeIs(1));
}

TEST_F(UploadsTest, UnfinishedOnesOfAnEarlierServerGo) {
  Send("a.jpg", kJpeg);
  WriteText(paths.photos() / ".upload-abc", "half");
  EXPECT_THAT(Names(), SizeIs(1));
  RemoveUnfinishedUploads(paths);
  EXPECT_FALSE(fs::exists(paths.photos() / ".upload-abc"));
  EXPECT_THAT(Names(), SizeIs(1));
}

}  // namespace
}  // namespace oraclegs
