<?xml version="1.0" encoding="UTF-8"?>
<!-- SPDX-License-Identifier: Apache-2.0 -->
<!-- SPDX-FileCopyrightText: The pm authors -->
<ColorCorrection id="a">
    <SOPNode>
        <Slope>1.1 1 0.9</Slope>
        <Offset>0 0 0</Offset>
        <Power>1 1 1</Power>
    </SOPNode>
    <SatNode>
        <Saturation>0.95</Saturation>
    </SatNode>
</ColorCorrection>
