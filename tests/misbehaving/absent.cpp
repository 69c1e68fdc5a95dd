// SPDX-License-Identifier: Apache-2.0
extern "C" int test_absent();
int test_absent() { return 42; }
