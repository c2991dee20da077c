#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# A sample of what long_fault.bats sweeps: calls of files that fail, and ends at them.

load sweeps

@test "a kill or a torn write anywhere loses nothing that was finished" {
    sweep snapgen write kill -e 25
    sweep fine write tear -e 25
    sweep adaptive write tear -e 60
    sweep moving write tear -e 40
    sweep moving rename kill
    sweep snapgen sync kill
    sweep reduced write kill -n 5
}

@test "a disk that is full, or fails, is said in one line" {
    sweep fullrun write fail -e 9
    sweep snapgen write last -e 29
    sweep snapgen read fail -e 29
    sweep moving write short -e 97
    sweep deimselect read fail -e 29
    sweep podbuild sync fail
    sweep fullrun rename fail
    sweep romrun close fail -e 5
    sweep residuals open fail -e 5
}
