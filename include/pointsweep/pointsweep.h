// SPDX-License-Identifier: MIT
/// The public interface of the core. In reading order:
///   attribute.h     attributes of points, and the layout of records
///   reader.h        inputs: files, arrays, readers of your own
///   files.h         lists of the files in folders and patterns
///   url.h           URLs in place of paths of files
///   cloud.h         several inputs as one cloud
///   neighborhood.h  which points are neighbours, and a batch of points as operators see it
///   operator.h      operators of your own; in_order_operator.h has operators that take all points in order
///   chain.h         operators in order, from C++, text or JSON
///   operators.h     the built-in operators
///   writer.h        outputs: files, arrays, writers of your own
///   arrays.h        points and results in arrays, without files, for short programs
///   run.h           running a chain: outputs, options, resources, observation
///   statistics.h    statistics of a run
///   error.h         exceptions
///   cancellation.h  work that stops when another thread or a signal asks for it
/// crs.h, geometry.h, option.h and export.h have types that several of these headers use. info.h (contents of files)
/// and verify.h (checks of results) belong to separate libraries. program/ has what programs that talk to people need
/// in addition, as the tool does: declarations of operators and options (declaration.h, pipeline.h, run_options.h),
/// formats by name, numbers as people write them, pictures, reports, generated clouds.
#pragma once

#include "pointsweep/arrays.h"
#include "pointsweep/attribute.h"
#include "pointsweep/cancellation.h"
#include "pointsweep/chain.h"
#include "pointsweep/cloud.h"
#include "pointsweep/crs.h"
#include "pointsweep/error.h"
#include "pointsweep/export.h"
#include "pointsweep/files.h"
#include "pointsweep/geometry.h"
#include "pointsweep/in_order_operator.h"
#include "pointsweep/neighborhood.h"
#include "pointsweep/operator.h"
#include "pointsweep/operators.h"
#include "pointsweep/option.h"
#include "pointsweep/reader.h"
#include "pointsweep/run.h"
#include "pointsweep/statistics.h"
#include "pointsweep/url.h"
#include "pointsweep/writer.h"
