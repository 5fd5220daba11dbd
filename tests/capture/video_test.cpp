#include "oraclegs/capture/video.h"

#include <algorithm>
#include <cstring>
#include <set>

#include "capture/video_files.h"
#include "oraclegs/core/files.h"
#include "oraclegs/image/read_image.h"
#include "support/errors.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

TEST(ExtractFrames, TakesTheSharpestOfEachPart) {
  const TempDir dir;
  const fs::path video = dir / "a 'clip': 1.mp4";
  WriteVideo(video, 4, {"-vf", "boxblur=8:enable='not(mod(n,5))+lt(mod(n,5),3)'"});
  EXPECT_TRUE(LooksLikeVideo(video));
  EXPECT_EQ(ProbeVideo(video), 40);
  EventRecorder events;
  ExtractFrames(video, 8, dir / "out", events.AsListener());
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(dir / "out")) names.push_back(entry.path().filename().string());
  EXPECT_EQ(names.size(), 8u);
  EXPECT_EQ(ReadImage(dir / "out/frame_0001.jpg").width, 160);
  EXPECT_TRUE(fs::exists(dir / "out/frame_0008.jpg"));
}

TEST(ExtractFrames, TakesWhatAShortVideoHas) {
  const TempDir dir;
  WriteVideo(dir / "a.mp4", .6);
  ExtractFrames(dir / "a.mp4", 24, dir / "out", Silent());
  EXPECT_EQ(std::distance(fs::directory_iterator(dir / "out"), fs::directory_iterator()), 6);
}

/// A failing ffmpeg beside the real ffprobe.
class FakeFfmpeg {
 public:
  explicit FakeFfmpeg(const std::string& body) : path_(std::getenv("PATH")) {
    WriteText(dir_ / "ffmpeg", "#!/bin/sh\n" + body + "\n");
    fs::permissions(dir_ / "ffmpeg", fs::perms::owner_all);
    setenv("PATH", (dir_.path().string() + ":" + path_).c_str(), 1);
    setenv("ORACLEGS_STALL_LIMIT", "0.3", 1);
  }
  ~FakeFfmpeg() {
    setenv("PATH", path_.c_str(), 1);
    unsetenv("ORACLEGS_STALL_LIMIT");
  }
  FakeFfmpeg(const FakeFfmpeg&) = delete;
  FakeFfmpeg& operator=(const FakeFfmpeg&) = delete;

 private:
  TempDir dir_;
  std::string path_;
};

/// The file, with another duration in its header: milliseconds in an element of eight bytes.
void PatchDuration(const fs::path& matroska, double milliseconds) {
  std::string bytes = ReadFile(matroska), number(8, '\0');
  const size_t at = bytes.find("\x44\x89\x88");
  ASSERT_NE(at, std::string::npos);
  std::memcpy(number.data(), &milliseconds, number.size());
  std::reverse(number.begin(), number.end());
  WriteText(matroska, bytes.replace(at + 3, number.size(), number));
}

TEST(ExtractFrames, DoesNotBelieveTheDuration) {
  const TempDir dir;
  WriteVideo(dir / "true.mkv", 4);
  ExtractFrames(dir / "true.mkv", 4, dir / "true", Silent());
  for (const double milliseconds : {.001, 100., 3.6e6, 1e300}) {
    const fs::path out = dir / fmt::format("{}", milliseconds);
    fs::copy_file(dir / "true.mkv", dir / "lie.mkv", fs::copy_options::overwrite_existing);
    PatchDuration(dir / "lie.mkv", milliseconds);
    ExtractFrames(dir / "lie.mkv", 4, out, Silent());
    EXPECT_EQ(std::distance(fs::directory_iterator(out), fs::directory_iterator()), 4) << milliseconds;
    EXPECT_EQ(ReadFile(out / "frame_0004.jpg"), ReadFile(dir / "true/frame_0004.jpg")) << milliseconds;
  }
}

TEST(ExtractFrames, WritesNoMoreFramesThanAskedFor) {
  const TempDir dir;
  WriteVideo(dir / "a.mp4", 1);
  const FakeFfmpeg fake("echo \"$@\" > " + (dir / "arguments").string() + "; exit 1");
  EXPECT_THROW(ExtractFrames(dir / "a.mp4", 1, dir / "out", Silent()), InputError);
  EXPECT_THAT(ReadFile(dir / "arguments"), HasSubstr("-frames:v 5 "));
}

TEST(ProbeVideo, RefusesListsOfOtherFiles) {
  const TempDir dir;
  WriteVideo(dir / "private.mp4", 4);
  const std::string path = fs::absolute(dir / "private.mp4").string();
  const std::pair<const char*, std::string> lists[] = {
      {"hls.mp4", "#EXTM3U\n#EXT-X-TARGETDURATION:10\n#EXTINF:4.0,\nfile://" + path + "\n#EXT-X-ENDLIST\n"},
      {"concat.mkv", "ffconcat version 1.0\nfile private.mp4\n"},
      {"session.mov", "v=0\no=- 0 0 IN IP4 127.0.0.1\ns=x\nc=IN IP4 127.0.0.1\nt=0 0\nm=video 5004 RTP/AVP 96\n"}};
  for (const auto& [name, text] : lists) {
    WriteText(dir / name, text);
    EXPECT_THAT(MessageOf<InputError>([&, file = name] { ProbeVideo(dir / file); }),
                HasSubstr("holds no video that ffmpeg"))
        << name;
    EXPECT_THROW(ExtractFrames(dir / name, 4, dir / "out", Silent()), InputError) << name;
  }
}

TEST(ExtractFrames, TakesDifferentFramesOfAllContainers) {
  const TempDir dir;
  for (const char* name : {"a.avi", "a.mkv", "a.mov", "a.ts"}) {
    const fs::path out = dir / (std::string(name) + "_out");
    WriteVideo(dir / name, 4, {"-vf", "fps=7"});
    ExtractFrames(dir / name, 20, out, Silent());
    std::set<std::string> images;
    for (const auto& entry : fs::directory_iterator(out)) images.insert(ReadFile(entry.path()));
    EXPECT_EQ(images.size(), 20u) << name;
  }
}

TEST(ProbeVideo, NamesWhatIsWrong) {
  const TempDir dir;
  WriteText(dir / "empty.mp4", "");
  WriteText(dir / "text.mp4", "no video");
  WriteVideo(dir / "short.mp4", .1);
  EXPECT_THAT(MessageOf<InputError>([&] { ProbeVideo(dir / "empty.mp4"); }), HasSubstr("empty.mp4: is empty"));
  EXPECT_THAT(MessageOf<InputError>([&] { ProbeVideo(dir / "text.mp4"); }), HasSubstr("text.mp4: holds no video"));
  EXPECT_THAT(MessageOf<InputError>([&] { ProbeVideo(dir / "short.mp4"); }), HasSubstr("short.mp4: is too short"));
  const std::string path = std::getenv("PATH");
  setenv("PATH", "/nonexistent", 1);
  EXPECT_THAT(MessageOf<InputError>([&] { ProbeVideo(dir / "short.mp4"); }), HasSubstr("apt install ffmpeg"));
  setenv("PATH", path.c_str(), 1);
}

TEST(ExtractFrames, WhatDisturbsFfmpegIsNotTheVideosFault) {
  const TempDir dir;
  WriteVideo(dir / "a.mp4", 1);
  const auto message_of = [&](const std::string& body) {
    const FakeFfmpeg fake(body);
    return MessageOf<RunError>([&] { ExtractFrames(dir / "a.mp4", 4, dir / "out", Silent()); });
  };
  EXPECT_THAT(message_of("sleep 30"), HasSubstr("a.mp4: ffmpeg did nothing for 0.3 s and was ended"));
  EXPECT_THAT(message_of("kill -KILL $$"), HasSubstr("a.mp4: ffmpeg was killed from outside"));
  EXPECT_THAT(message_of("echo lib missing >&2; exit 127"), HasSubstr("a.mp4: ffmpeg cannot be run (lib missing)"));
  EXPECT_THAT(message_of("echo No space left on device >&2; exit 1"), HasSubstr("make room there"));
  const FakeFfmpeg fake("echo rubbish >&2; exit 1");
  EXPECT_THAT(MessageOf<InputError>([&] { ExtractFrames(dir / "a.mp4", 4, dir / "out", Silent()); }),
              HasSubstr("holds no video that ffmpeg can read (rubbish)"));
}

TEST(LooksLikeVideo, KnowsNamesAndContents) {
  const TempDir dir;
  WriteText(dir / "a", std::string("\0\0\0\x18"
                                   "ftypisom....",
                                   16));
  WriteText(dir / "b", std::string("\0\0\0\x18"
                                   "ftypheic....",
                                   16));
  WriteText(dir / "c.txt", "text");
  EXPECT_TRUE(LooksLikeVideo(dir / "a"));
  EXPECT_FALSE(LooksLikeVideo(dir / "b"));
  EXPECT_FALSE(LooksLikeVideo(dir / "c.txt"));
  EXPECT_TRUE(LooksLikeVideo("missing.MOV"));
}

TEST(ParseProbe, ReadsWhatFfprobeSays) {
  EXPECT_EQ(ParseProbe(R"(noise {"streams": [{"nb_read_packets": "90"}]} end)", "f"), 90);
}

TEST(ParseProbe, RefusesOddAnswers) {
  for (const char* answer :
       {"", "}{", "{", R"({"streams": []})", R"({"streams": [{}]})", R"({"streams": 3})",
        R"({"streams": [{"nb_read_packets": 90}]})", R"({"streams": [{"nb_read_packets": "nan"}]})",
        R"({"streams": [{"nb_read_packets": "9e3"}]})", R"({"streams": [{"nb_read_packets": "-90"}]})",
        R"({"streams": [{"nb_read_packets": "99999999999999999999"}]})"}) {
    EXPECT_THAT(MessageOf<InputError>([&] { ParseProbe(answer, "v.mp4"); }), HasSubstr("v.mp4: ")) << answer;
  }
}

}  // namespace
}  // namespace oraclegs
