#include "oraclegs/scene/fold_name.h"

#include <cstdint>
#include <unordered_map>

namespace oraclegs {
namespace {

struct Accented {
  char32_t base;
  std::u32string_view letters;  ///< that decompose to the base, or its capital, and accents
};

// clang-format off
constexpr Accented kAccented[] = {
    {U'a', U"ÀÁÂÃÄÅàáâãäåĀāĂăĄąǍǎǞǟǠǡǺǻȀȁȂȃȦȧḀḁẠạẢảẤấẦầẨẩẪẫẬậẮắẰằẲẳẴẵẶặ"},
    {U'b', U"ḂḃḄḅḆḇ"},
    {U'c', U"ÇçĆćĈĉĊċČčḈḉ"},
    {U'd', U"ĎďḊḋḌḍḎḏḐḑḒḓ"},
    {U'e', U"ÈÉÊËèéêëĒēĔĕĖėĘęĚěȄȅȆȇȨȩḔḕḖḗḘḙḚḛḜḝẸẹẺẻẼẽẾếỀềỂểỄễỆệ"},
    {U'f', U"Ḟḟ"},
    {U'g', U"ĜĝĞğĠġĢģǦǧǴǵḠḡ"},
    {U'h', U"ĤĥȞȟḢḣḤḥḦḧḨḩḪḫẖ"},
    {U'i', U"ÌÍÎÏìíîïĨĩĪīĬĭĮįİǏǐȈȉȊȋḬḭḮḯỈỉỊị"},
    {U'j', U"Ĵĵǰ"},
    {U'k', U"ĶķǨǩḰḱḲḳḴḵ"},
    {U'l', U"ĹĺĻļĽľḶḷḸḹḺḻḼḽ"},
    {U'm', U"ḾḿṀṁṂṃ"},
    {U'n', U"ÑñŃńŅņŇňǸǹṄṅṆṇṈṉṊṋ"},
    {U'o', U"ÒÓÔÕÖòóôõöŌōŎŏŐőƠơǑǒǪǫǬǭȌȍȎȏȪȫȬȭȮȯȰȱṌṍṎṏṐṑṒṓỌọỎỏỐốỒồỔổỖỗỘộỚớỜờỞởỠỡỢợ"},
    {U'p', U"ṔṕṖṗ"},
    {U'r', U"ŔŕŖŗŘřȐȑȒȓṘṙṚṛṜṝṞṟ"},
    {U's', U"ŚśŜŝŞşŠšȘșṠṡṢṣṤṥṦṧṨṩ"},
    {U't', U"ŢţŤťȚțṪṫṬṭṮṯṰṱẗ"},
    {U'u', U"ÙÚÛÜùúûüŨũŪūŬŭŮůŰűŲųƯưǓǔǕǖǗǘǙǚǛǜȔȕȖȗṲṳṴṵṶṷṸṹṺṻỤụỦủỨứỪừỬửỮữỰự"},
    {U'v', U"ṼṽṾṿ"},
    {U'w', U"ŴŵẀẁẂẃẄẅẆẇẈẉẘ"},
    {U'x', U"ẊẋẌẍ"},
    {U'y', U"ÝýÿŶŷŸȲȳẎẏẙỲỳỴỵỶỷỸỹ"},
    {U'z', U"ŹźŻżŽžẐẑẒẓẔẕ"},
    {U'æ', U"ǢǣǼǽ"},
    {U'ø', U"Ǿǿ"},
    {U'ʒ', U"Ǯǯ"},
    {U'α', U"Άά"},
    {U'ε', U"Έέ"},
    {U'η', U"Ήή"},
    {U'ι', U"ΊΐΪίϊ"},
    {U'ο', U"Όό"},
    {U'υ', U"ΎΫΰϋύ"},
    {U'ω', U"Ώώ"},
    {U'г', U"Ѓѓ"},
    {U'е', U"ЀЁѐё"},
    {U'и', U"ЍЙйѝ"},
    {U'к', U"Ќќ"},
    {U'у', U"Ўў"},
    {U'і', U"Її"},
    {U'う', U"ゔ"},
    {U'か', U"が"},
    {U'き', U"ぎ"},
    {U'く', U"ぐ"},
    {U'け', U"げ"},
    {U'こ', U"ご"},
    {U'さ', U"ざ"},
    {U'し', U"じ"},
    {U'す', U"ず"},
    {U'せ', U"ぜ"},
    {U'そ', U"ぞ"},
    {U'た', U"だ"},
    {U'ち', U"ぢ"},
    {U'つ', U"づ"},
    {U'て', U"で"},
    {U'と', U"ど"},
    {U'は', U"ばぱ"},
    {U'ひ', U"びぴ"},
    {U'ふ', U"ぶぷ"},
    {U'へ', U"べぺ"},
    {U'ほ', U"ぼぽ"},
    {U'ゝ', U"ゞ"},
    {U'ウ', U"ヴ"},
    {U'カ', U"ガ"},
    {U'キ', U"ギ"},
    {U'ク', U"グ"},
    {U'ケ', U"ゲ"},
    {U'コ', U"ゴ"},
    {U'サ', U"ザ"},
    {U'シ', U"ジ"},
    {U'ス', U"ズ"},
    {U'セ', U"ゼ"},
    {U'ソ', U"ゾ"},
    {U'タ', U"ダ"},
    {U'チ', U"ヂ"},
    {U'ツ', U"ヅ"},
    {U'テ', U"デ"},
    {U'ト', U"ド"},
    {U'ハ', U"バパ"},
    {U'ヒ', U"ビピ"},
    {U'フ', U"ブプ"},
    {U'ヘ', U"ベペ"},
    {U'ホ', U"ボポ"},
    {U'ワ', U"ヷ"},
    {U'ヰ', U"ヸ"},
    {U'ヱ', U"ヹ"},
    {U'ヲ', U"ヺ"},
    {U'ヽ', U"ヾ"},
};
// clang-format on

bool IsAccent(char32_t c) { return (c >= 0x300 && c <= 0x36F) || c == 0x3099 || c == 0x309A; }

/// Takes the next character off the front of `text`; 0 for a byte that is not UTF-8.
char32_t TakeCharacter(std::string_view* text) {
  const auto byte = [&](size_t i) { return static_cast<unsigned char>((*text)[i]); };
  const unsigned char first = byte(0);
  const size_t length = first < 0x80   ? 1
                        : first < 0xC2 ? 0
                        : first < 0xE0 ? 2
                        : first < 0xF0 ? 3
                        : first < 0xF5 ? 4
                                       : 0;
  char32_t c = length < 2 ? first : first & (0xFFu >> (length + 1));
  bool valid = length > 0 && length <= text->size();
  for (size_t i = 1; valid && i < length; ++i) {
    valid = (byte(i) & 0xC0) == 0x80;
    c = (c << 6) | (byte(i) & 0x3Fu);
  }
  text->remove_prefix(valid ? length : 1);
  return valid ? c : 0;
}

void AppendUtf8(char32_t c, std::string* text) {
  const auto add = [&](char32_t bits) { text->push_back(static_cast<char>(bits)); };
  if (c < 0x80) return add(c);
  if (c < 0x800) {
    add(0xC0 | (c >> 6));
  } else if (c < 0x10000) {
    add(0xE0 | (c >> 12));
    add(0x80 | ((c >> 6) & 0x3F));
  } else {
    add(0xF0 | (c >> 18));
    add(0x80 | ((c >> 12) & 0x3F));
    add(0x80 | ((c >> 6) & 0x3F));
  }
  add(0x80 | (c & 0x3F));
}

char32_t LowerCase(char32_t c) {
  if (c < 0x80) return c >= 'A' && c <= 'Z' ? c + 0x20 : c;
  const bool greek = c >= 0x391 && c <= 0x3A9, cyrillic = c >= 0x410 && c <= 0x42F;
  if (greek || cyrillic || (c >= 0xC0 && c <= 0xDE && c != 0xD7)) return c + 0x20;
  return c >= 0x400 && c <= 0x40F ? c + 0x50 : c;
}

char32_t WithoutAccent(char32_t c) {
  static const std::unordered_map<char32_t, char32_t> bases = [] {
    std::unordered_map<char32_t, char32_t> made;
    for (const Accented& group : kAccented) {
      for (const char32_t letter : group.letters) made.emplace(letter, group.base);
    }
    return made;
  }();
  const auto base = bases.find(c);
  return base == bases.end() ? LowerCase(c) : base->second;
}

/// A Hangul syllable as its letters, by the arithmetic of the Unicode standard.
void AppendSyllable(char32_t c, std::string* text) {
  constexpr char32_t kVowels = 21, kTails = 28;
  const char32_t index = c - 0xAC00;
  AppendUtf8(0x1100 + index / (kVowels * kTails), text);
  AppendUtf8(0x1161 + index / kTails % kVowels, text);
  if (index % kTails != 0) AppendUtf8(0x11A7 + index % kTails, text);
}

}  // namespace

std::string FoldName(std::string_view name) {
  std::string folded;
  folded.reserve(name.size());
  while (!name.empty()) {
    const char raw = name.front();
    const char32_t c = TakeCharacter(&name);
    if (c == 0) {
      folded.push_back(raw);
    } else if (c >= 0xAC00 && c <= 0xD7A3) {
      AppendSyllable(c, &folded);
    } else if (!IsAccent(c)) {
      AppendUtf8(WithoutAccent(c), &folded);
    }
  }
  return folded;
}

}  // namespace oraclegs
