// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cassert>
#include <cstddef>
#include <iterator>
#include <span>
#include <vector>

#include "base/simd.h"

namespace sextant {

/// A whitened 2D-3D pair: r = inverse_sigma * (pixel - projection), the residual of residuals.h
/// with unit variance on each axis.
struct PixelTerm {
  Eigen::Vector2d pixel;
  Eigen::Vector3d in_lidar;
  double inverse_sigma = 1.0;
};

/// Eight terms, number by number, for SIMD vectors of 8 doubles. Padding repeats the first term of
/// the block with inverse_sigma zero: it projects where that term does, and adds nothing.
struct alignas(64) PixelBlock {
  double x[kSimdWidth], y[kSimdWidth], z[kSimdWidth];  ///< In the LiDAR frame [m].
  double u[kSimdWidth], v[kSimdWidth];                 ///< The pixel.
  double inverse_sigma[kSimdWidth];
};

inline PixelTerm TermAt(const PixelBlock* blocks, std::size_t i) {
  const PixelBlock& b = blocks[i / kSimdWidth];
  const std::size_t k = i % kSimdWidth;
  return {{b.u[k], b.v[k]}, {b.x[k], b.y[k], b.z[k]}, b.inverse_sigma[k]};
}

/// Terms one by one, by value; they are stored as blocks.
class PixelTermsView {
 public:
  class Iterator {
   public:
    using iterator_category = std::input_iterator_tag;
    using value_type = PixelTerm;
    using difference_type = std::ptrdiff_t;
    using pointer = const PixelTerm*;
    using reference = PixelTerm;

    Iterator(const PixelBlock* blocks, std::size_t at) : blocks_(blocks), at_(at) {}
    PixelTerm operator*() const { return TermAt(blocks_, at_); }
    Iterator& operator++() {
      ++at_;
      return *this;
    }
    bool operator==(const Iterator& other) const { return at_ == other.at_; }
    bool operator!=(const Iterator& other) const { return at_ != other.at_; }

   private:
    const PixelBlock* blocks_;
    std::size_t at_;
  };

  PixelTermsView() = default;
  PixelTermsView(const PixelBlock* blocks, std::size_t size) : blocks_(blocks), size_(size) {}

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  PixelTerm operator[](std::size_t i) const { return TermAt(blocks_, i); }
  Iterator begin() const { return {blocks_, 0}; }
  Iterator end() const { return {blocks_, size_}; }

  std::span<const PixelBlock> blocks() const {
    return {blocks_, (size_ + kSimdWidth - 1) / kSimdWidth};
  }

 private:
  const PixelBlock* blocks_ = nullptr;
  std::size_t size_ = 0;
};

/// The same, owned. Allocates nothing once it has held as many terms.
class PixelTerms {
 public:
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  void clear() {
    blocks_.clear();
    size_ = 0;
  }
  void reserve(std::size_t count) { blocks_.reserve((count + kSimdWidth - 1) / kSimdWidth); }
  void push_back(const PixelTerm& term) {
    const std::size_t k = size_ % kSimdWidth;
    if (k == 0) AddBlock(term);
    PixelBlock& block = blocks_.back();
    block.x[k] = term.in_lidar.x();
    block.y[k] = term.in_lidar.y();
    block.z[k] = term.in_lidar.z();
    block.u[k] = term.pixel.x();
    block.v[k] = term.pixel.y();
    block.inverse_sigma[k] = term.inverse_sigma;
    ++size_;
  }

  /// Appends up to eight terms. Requires that the terms so far fill their blocks.
  void AppendBlock(const PixelBlock& block, std::size_t count) {
    assert(size_ % kSimdWidth == 0);
    blocks_.push_back(block);
    size_ += count;
  }

  PixelTermsView View() const { return {blocks_.data(), size_}; }
  PixelTerm operator[](std::size_t i) const { return View()[i]; }
  PixelTermsView::Iterator begin() const { return View().begin(); }
  PixelTermsView::Iterator end() const { return View().end(); }
  std::span<const PixelBlock> blocks() const { return blocks_; }

 private:
  // Appends a block of padding that repeats the term.
  void AddBlock(const PixelTerm& term);

  std::vector<PixelBlock> blocks_;
  std::size_t size_ = 0;
};

}  // namespace sextant
