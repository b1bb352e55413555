// SPDX-License-Identifier: MIT
/// Wrong on purpose: no layer has this name. The layer check must refuse it.
#pragma once
