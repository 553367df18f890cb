// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
#include <functional>

namespace pm {

// Fills the rows of a table in the threads that are there. May be called while others wait for the
// table: a thread that fills it takes up no other work before it is done.
void forEachTableRow(std::size_t rows, const std::function<void(std::size_t)>& fill);

}  // namespace pm
