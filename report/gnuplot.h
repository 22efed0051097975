// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "base/error.h"

namespace sextant {

enum class PlotFormat { kSvg, kPng, kPdf };

/// The picture that gnuplot draws by the commands, which need not name a terminal or an output. The
/// program is started without a shell and without the user's initialisation files, reads the
/// commands from its standard input, and writes to its standard output alone, so that no name of a
/// file is part of a command. Texts within the commands must come from GnuplotText (base/text), as
/// gnuplot can start programs.
///
/// The same commands give the same bytes; a PDF has no date.
/// Errors: kMissingData (gnuplot is not installed), kIo (gnuplot's own message; 60 s passed; the
/// picture is incomplete).
Expected<std::string> RunGnuplot(const std::string& commands, PlotFormat format);

}  // namespace sextant
