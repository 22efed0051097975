// SPDX-License-Identifier: Apache-2.0
// No kernel allocates after its first call: this binary counts every call of malloc, which operator
// new and Eigen's dynamic matrices use.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdlib>

#include "eval/synthetic/mismatched_pairs.h"
#include "solvers/builtin_solvers.h"
#include "solvers/core/registry.h"
#include "support/kernel_calls.h"

#if defined(__GLIBC__) && !defined(SEXTANT_SANITIZED)
#define SEXTANT_COUNTS_ALLOCATIONS
#endif

namespace {
// For this thread; a plain number without initialisation, as malloc is called before main.
thread_local long allocations = 0;
}  // namespace

#ifdef SEXTANT_COUNTS_ALLOCATIONS
// The C library's own functions, under the names that it exports for this purpose.
// NOLINTBEGIN: names are those of the C library.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  ++allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
  ++allocations;
  return __libc_realloc(old, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++allocations;
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** result, std::size_t alignment, std::size_t size) {
  ++allocations;
  *result = __libc_memalign(alignment, size);
  return *result == nullptr ? 12 : 0;
}
}
// NOLINTEND
#endif

namespace sextant::test {
namespace {

class Allocation : public testing::Test {
 protected:
  void SetUp() override {
#ifndef SEXTANT_COUNTS_ALLOCATIONS
    GTEST_SKIP() << "allocations cannot be counted with a sanitizer or another C library";
#endif
  }
};

template <class Call>
long AllocationsOf(const Call& call) {
  const long before = allocations;
  call();
  return allocations - before;
}

// A compiler may remove an allocation that does not escape.
void* volatile escaped = nullptr;

TEST_F(Allocation, IsCounted) {
  EXPECT_EQ(AllocationsOf([] {
              escaped = std::malloc(100);
              std::free(escaped);
            }),
            1);
  EXPECT_EQ(AllocationsOf([] {
              auto* number = new double(1.0);
              escaped = number;
              delete number;
            }),
            1);
  EXPECT_EQ(AllocationsOf([] {
              std::vector<double> numbers(3);
              escaped = numbers.data();
              numbers.push_back(1.0);
              escaped = numbers.data();
            }),
            2);
  EXPECT_EQ(AllocationsOf([] {
              Eigen::VectorXd numbers = Eigen::VectorXd::Zero(9);
              escaped = numbers.data();
            }),
            1);
  EXPECT_EQ(AllocationsOf([] { Eigen::Matrix3d::Zero().eval(); }), 0);
}

TEST_F(Allocation, NoKernelAllocates) {
  for (const KernelCall& kernel : KernelCalls()) {
    kernel.call();  // Buffers grow to their size in the first call.
    EXPECT_EQ(AllocationsOf(kernel.call), 0)
        << kernel.name << ", in " << kernel.problems << " problems";
  }
}

// A scene without a consensus, so that ransac draws all samples that it may.
CalibrationProblem Hopeless(bool pixels) {
  const RandomSceneOptions options{.pairs = 100, .sigma_m = 0.01, .sigma_px = 1.0};
  Random random(3);
  RandomScene scene = MakeRandomScene(options, random);
  MismatchPairs(options, 0, random, scene);
  scene.problem.point_sets = {};
  if (pixels) scene.problem.pairs_3d3d.clear();
  if (!pixels) scene.problem.pairs_2d3d.clear();
  return scene.problem;
}

TEST_F(Allocation, TheLoopOfRansacAllocatesNothing) {
  for (const std::string inner : {"kabsch", "p3p", "epnp"}) {
    const CalibrationProblem problem = Hopeless(inner != "kabsch");
    const auto of_iterations = [&](int count) {
      const SolverPtr solver = *BuiltinSolvers().Make(
          "ransac(" + inner + ",max_iterations=" + std::to_string(count) + ")");
      static_cast<void>(solver->Solve(problem));
      return AllocationsOf([&] { static_cast<void>(solver->Solve(problem)); });
    };
    // Each new best pose may allocate a buffer.
    EXPECT_NEAR(static_cast<double>(of_iterations(2000)), static_cast<double>(of_iterations(1000)),
                20.0)
        << inner;
  }
}

}  // namespace
}  // namespace sextant::test
