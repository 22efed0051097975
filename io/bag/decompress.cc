// SPDX-License-Identifier: Apache-2.0
#include "io/bag/decompress.h"

#include <bzlib.h>
#include <fmt/core.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <memory>

#include "io/text/number_text.h"

namespace sextant {
namespace {

constexpr std::size_t kStep = std::size_t{1} << 20;
constexpr std::size_t kUncheckedSize = std::size_t{64} << 20;
constexpr std::size_t kMaxRatio = 256;

/// The result of one call of a decoder.
struct DecoderStep {
  bool failed = false;
  bool ended = false;
  std::size_t consumed = 0;
  std::size_t produced = 0;
};

// Whether the end of the stream may be missing.
enum class StreamExtent { kWhole, kBegun };

// Calls `decode(input, output, room)` until its stream ends. The output grows as it is produced.
template <class Decode>
Expected<std::string> Run(std::string_view input, std::size_t size, StreamExtent stream,
                          Decode decode) {
  if (size > kUncheckedSize && size / kMaxRatio > input.size()) {
    return MakeError(ErrorCode::kParse,
                     fmt::format("{} compressed bytes are stated to hold {} bytes, more than {} "
                                 "times as many",
                                 input.size(), size, kMaxRatio));
  }
  std::string output;
  std::size_t filled = 0;
  while (true) {
    // One byte more than stated, so that a longer stream is detected.
    if (filled == output.size()) {
      output.resize(std::min(size + 1, filled + std::max(kStep, filled)));
    }
    const DecoderStep step = decode(input, output.data() + filled, output.size() - filled);
    const bool stalls = !step.ended && step.consumed == 0 && step.produced == 0;
    if (stream == StreamExtent::kBegun && (step.failed || stalls)) {
      output.resize(filled);
      return output;
    }
    if (step.failed) return MakeError(ErrorCode::kParse, "its compressed data is damaged");
    input.remove_prefix(step.consumed);
    filled += step.produced;
    if (filled > size || (step.ended && filled != size)) {
      return MakeError(
          ErrorCode::kParse,
          fmt::format("its compressed data holds {}{} bytes, expected {}",
                      filled > size ? "more than " : "", std::min(filled, size), size));
    }
    if (step.ended) break;
    if (stalls) {
      return MakeError(ErrorCode::kParse, "its compressed data is cut short");
    }
  }
  output.resize(size);
  return output;
}

Expected<std::string> DecompressBz2(std::string_view bytes, std::size_t size, StreamExtent end) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) {
    return MakeError(ErrorCode::kParse, "bz2 cannot be started");
  }
  const std::unique_ptr<bz_stream, int (*)(bz_stream*)> guard(&stream, BZ2_bzDecompressEnd);
  return Run(bytes, size, end, [&stream](std::string_view input, char* output, std::size_t room) {
    const auto in = static_cast<unsigned>(std::min(input.size(), kStep));
    const auto out = static_cast<unsigned>(std::min(room, kStep));
    std::string block(input.substr(0, in));  // bz2 requires writable input.
    stream.next_in = block.data();
    stream.avail_in = in;
    stream.next_out = output;
    stream.avail_out = out;
    const int result = BZ2_bzDecompress(&stream);
    return DecoderStep{.failed = result != BZ_OK && result != BZ_STREAM_END,
                       .ended = result == BZ_STREAM_END,
                       .consumed = in - stream.avail_in,
                       .produced = out - stream.avail_out};
  });
}

Expected<std::string> DecompressLz4(std::string_view bytes, std::size_t size, StreamExtent end) {
  LZ4F_dctx* raw = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&raw, LZ4F_VERSION)) != 0U) {
    return MakeError(ErrorCode::kParse, "lz4 cannot be started");
  }
  const std::unique_ptr<LZ4F_dctx, LZ4F_errorCode_t (*)(LZ4F_dctx*)> context(
      raw, LZ4F_freeDecompressionContext);
  return Run(bytes, size, end, [&context](std::string_view input, char* output, std::size_t room) {
    std::size_t in = input.size();
    std::size_t out = room;
    const std::size_t result =
        LZ4F_decompress(context.get(), output, &out, input.data(), &in, nullptr);
    return DecoderStep{.failed = LZ4F_isError(result) != 0U,
                       .ended = result == 0,
                       .consumed = in,
                       .produced = out};
  });
}

Expected<std::string> DecompressZstd(std::string_view bytes, std::size_t size, StreamExtent end) {
  const std::unique_ptr<ZSTD_DStream, std::size_t (*)(ZSTD_DStream*)> stream(ZSTD_createDStream(),
                                                                             ZSTD_freeDStream);
  return Run(bytes, size, end, [&stream](std::string_view input, char* output, std::size_t room) {
    ZSTD_inBuffer in{input.data(), input.size(), 0};
    ZSTD_outBuffer out{output, room, 0};
    const std::size_t result = ZSTD_decompressStream(stream.get(), &out, &in);
    return DecoderStep{.failed = ZSTD_isError(result) != 0U,
                       .ended = result == 0,
                       .consumed = in.pos,
                       .produced = out.pos};
  });
}

Expected<std::string> DecompressStream(Compression compression, std::string_view bytes,
                                       std::size_t size, StreamExtent stream) {
  switch (compression) {
    case Compression::kBz2:
      return DecompressBz2(bytes, size, stream);
    case Compression::kLz4:
      return DecompressLz4(bytes, size, stream);
    case Compression::kZstd:
      return DecompressZstd(bytes, size, stream);
    case Compression::kNone:
      break;
  }
  if (stream == StreamExtent::kBegun || bytes.size() == size) return std::string(bytes);
  return MakeError(ErrorCode::kParse,
                   fmt::format("it holds {} bytes, expected {}", bytes.size(), size));
}

std::string CompressBz2(std::string_view bytes) {
  std::string input(bytes);
  std::string output(bytes.size() + bytes.size() / 100 + 600, '\0');  // bzlib.h's own bound.
  auto size = static_cast<unsigned>(output.size());
  BZ2_bzBuffToBuffCompress(output.data(), &size, input.data(), static_cast<unsigned>(input.size()),
                           9, 0, 0);
  output.resize(size);
  return output;
}

std::string CompressLz4(std::string_view bytes) {
  LZ4F_preferences_t preferences = LZ4F_INIT_PREFERENCES;
  preferences.frameInfo.blockMode = LZ4F_blockIndependent;
  preferences.frameInfo.blockSizeID = LZ4F_max4MB;
  preferences.frameInfo.contentChecksumFlag = LZ4F_contentChecksumEnabled;
  std::string output(LZ4F_compressFrameBound(bytes.size(), &preferences), '\0');
  output.resize(
      LZ4F_compressFrame(output.data(), output.size(), bytes.data(), bytes.size(), &preferences));
  return output;
}

}  // namespace

Expected<Compression> CompressionNamed(std::string_view name) {
  if (name.empty() || name == "none") return Compression::kNone;
  if (name == "bz2") return Compression::kBz2;
  if (name == "lz4") return Compression::kLz4;
  if (name == "zstd") return Compression::kZstd;
  return MakeError(
      ErrorCode::kParse,
      fmt::format("unknown compression {}, expected none, bz2, lz4 or zstd", Quoted(name)));
}

Expected<std::string> Decompress(Compression compression, std::string_view bytes,
                                 std::size_t size) {
  return DecompressStream(compression, bytes, size, StreamExtent::kWhole);
}

std::string DecompressBegun(Compression compression, std::string_view bytes, std::size_t size) {
  return DecompressStream(compression, bytes, size, StreamExtent::kBegun).value_or(std::string());
}

Expected<std::string> DecompressZstdFrame(std::string_view bytes) {
  const unsigned long long size = ZSTD_getFrameContentSize(bytes.data(), bytes.size());
  if (size == ZSTD_CONTENTSIZE_UNKNOWN || size == ZSTD_CONTENTSIZE_ERROR) {
    return MakeError(ErrorCode::kParse, "expected a zstd frame that states its size");
  }
  return DecompressZstd(bytes, size, StreamExtent::kWhole);
}

std::string Compress(Compression compression, std::string_view bytes) {
  if (compression == Compression::kBz2) return CompressBz2(bytes);
  if (compression == Compression::kLz4) return CompressLz4(bytes);
  return std::string(bytes);
}

}  // namespace sextant
