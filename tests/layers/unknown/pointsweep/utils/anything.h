// SPDX-License-Identifier: MIT
/// Wrong on purpose: no layer is called utils. The layer check must refuse this file.
#pragma once
