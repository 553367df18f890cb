// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

// Colour and pictures throw the same exception; colour is built upon pictures.
#include "host_shim/pictures/host_error.h"
