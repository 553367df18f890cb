// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/materials/lobes/table_rows.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace pm {

void forEachTableRow(std::size_t rows, const std::function<void(std::size_t)>& fill) {
    tbb::this_task_arena::isolate([&] { tbb::parallel_for(std::size_t{0}, rows, fill); });
}

}  // namespace pm
