// Offsets, sizes, enums and limits of formats/spool.md and nothing else.
//
// Each namespace below is one byte table of the page; a test compares the two.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace spool::format {

// [spool.md 3.1]
namespace file_header {
inline constexpr size_t kMagic = 0;
inline constexpr size_t kMajor = 8;
inline constexpr size_t kMinor = 10;
inline constexpr size_t kRequiredFeatures = 12;
inline constexpr size_t kDumpUuid = 16;
inline constexpr size_t kReserved = 32;
inline constexpr size_t kCrc32 = 60;
}  // namespace file_header

// [spool.md 3.2]
namespace record_header {
inline constexpr size_t kSync = 0;
inline constexpr size_t kType = 4;
inline constexpr size_t kSequence = 8;
inline constexpr size_t kDumpId = 16;
inline constexpr size_t kStoredBytes = 24;
inline constexpr size_t kRawBytes = 32;
inline constexpr size_t kPayloadCrc32 = 40;
inline constexpr size_t kCodec = 44;
inline constexpr size_t kFilter = 45;
inline constexpr size_t kGroup = 46;
inline constexpr size_t kTile = 48;
inline constexpr size_t kSampleBegin = 52;
inline constexpr size_t kSampleCount = 56;
inline constexpr size_t kCrc32 = 60;
}  // namespace record_header

// [spool.md 3.3]
namespace footer {
inline constexpr size_t kIndexOffset = 0;
inline constexpr size_t kFileBytes = 8;
inline constexpr size_t kRecordCount = 16;
inline constexpr size_t kDumpId = 24;
inline constexpr size_t kDataRecordCount = 32;
inline constexpr size_t kFlags = 40;
inline constexpr size_t kReserved = 44;
inline constexpr size_t kEndMagic = 52;
inline constexpr size_t kCrc32 = 60;
}  // namespace footer

// [spool.md 4.1]
namespace imag {
inline constexpr size_t kWidth = 0;
inline constexpr size_t kHeight = 4;
inline constexpr size_t kTileSize = 8;
inline constexpr size_t kSpp = 12;
inline constexpr size_t kBlockSpp = 16;
inline constexpr size_t kGroupCount = 20;
inline constexpr size_t kChannelCount = 24;
inline constexpr size_t kPixelFilter = 28;
inline constexpr size_t kColourSpace = 32;
inline constexpr size_t kSampleOrder = 36;
inline constexpr size_t kReserved = 40;
}  // namespace imag

// [spool.md 4.2]
namespace chan {
inline constexpr size_t kName = 0;
inline constexpr size_t kGroup = 32;
inline constexpr size_t kDtype = 34;
inline constexpr size_t kSemantic = 36;
inline constexpr size_t kScope = 38;
inline constexpr size_t kReserved = 40;
}  // namespace chan

// [spool.md 4.5] An index entry is the offset and bytes 4-59 of the record header.
namespace index_entry {
inline constexpr size_t kOffset = 0;
inline constexpr size_t kType = 8;
inline constexpr size_t kSequence = 12;
inline constexpr size_t kDumpId = 20;
inline constexpr size_t kStoredBytes = 28;
inline constexpr size_t kRawBytes = 36;
inline constexpr size_t kPayloadCrc32 = 44;
inline constexpr size_t kCodec = 48;
inline constexpr size_t kFilter = 49;
inline constexpr size_t kGroup = 50;
inline constexpr size_t kTile = 52;
inline constexpr size_t kSampleBegin = 56;
inline constexpr size_t kSampleCount = 60;
}  // namespace index_entry

// Every structure, every IMAG payload, every CHAN entry and every index entry has this size, and
// every record starts at a multiple of it.
inline constexpr size_t kUnit = 64;

inline constexpr std::array<uint8_t, 8> kMagicBytes = {0x89, 0x53, 0x50, 0x4C,
                                                       0x0D, 0x0A, 0x1A, 0x0A};
inline constexpr std::array<uint8_t, 4> kSyncBytes = {0x9E, 0x52, 0x45, 0x43};
inline constexpr std::array<uint8_t, 8> kEndMagicBytes = {0x53, 0x50, 0x4C, 0x45,
                                                          0x4E, 0x44, 0x0D, 0x0A};
inline constexpr uint16_t kMajorVersion = 1;
inline constexpr uint16_t kMinorVersion = 0;
inline constexpr uint32_t kKnownFeatures = 0;
inline constexpr uint32_t kFlagComplete = 1;

inline constexpr std::string_view kTypeImag = "IMAG";
inline constexpr std::string_view kTypeChan = "CHAN";
inline constexpr std::string_view kTypeData = "DATA";
inline constexpr std::string_view kTypeIndx = "INDX";
inline constexpr std::string_view kTypeMeta = "meta";

enum class DataType : uint16_t { kFloat16 = 1, kFloat32 = 2, kUint32 = 3 };
enum class Scope : uint16_t { kSample = 0, kPixel = 1, kPass = 2 };
// As texts write them: in the order of their numbers.
inline constexpr std::array<std::string_view, 4> kDataTypeNames = {"", "f16", "f32", "u32"};
inline constexpr std::array<std::string_view, 3> kScopeNames = {"sample", "pixel", "pass"};
enum class SampleOrder : uint32_t { kRenderer = 0, kExchangeable = 1 };
enum class PixelFilter : uint32_t { kBox = 0 };
enum class ColourSpace : uint32_t { kLinearRec709 = 0 };
enum class Codec : uint8_t { kNone = 0, kZstd = 1 };
enum class Filter : uint8_t { kNone = 0, kByteShuffle = 1 };
// What a number is; ChannelInfo keeps it as a plain uint16_t.
enum class Semantic : uint16_t {
  kNotStated = 0,
  kLight = 1,
  kReflectance = 2,
  kDirection = 3,
  kPosition = 4,
  kDistance = 5,
  kSampleCoordinate = 6,
  kLightVariance = 7,
  kFraction = 8,
  kBits = 9,
};

// [spool.md 6]
inline constexpr uint32_t kMaxSide = 65536;
inline constexpr uint64_t kMaxPixels = uint64_t{1} << 28;
inline constexpr uint32_t kMinTileSize = 8;
inline constexpr uint32_t kMaxTileSize = 256;
inline constexpr uint32_t kMaxSpp = 65536;
inline constexpr uint32_t kMaxBlockSpp = 1024;
inline constexpr uint32_t kMaxGroups = 16;
inline constexpr uint32_t kMinChannels = 3;
inline constexpr uint32_t kMaxChannels = 64;
inline constexpr size_t kMaxNameBytes = 31;
inline constexpr uint64_t kMaxRawBytes = uint64_t{64} << 20;
inline constexpr uint64_t kMinRecords = 3;
inline constexpr uint64_t kMaxRecords = uint64_t{1} << 20;
inline constexpr uint64_t kMaxBlocks = kMaxRecords - 1024;
inline constexpr uint32_t kMaxMetaRecords = 64;
inline constexpr uint64_t kMinMetaBytes = 2;
inline constexpr uint64_t kMaxMetaBytes = uint64_t{1} << 20;
inline constexpr int kMaxMetaDepth = 64;
inline constexpr uint64_t kMaxZstdWindow = uint64_t{64} << 20;

}  // namespace spool::format
