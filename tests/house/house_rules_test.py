#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""That house_rules.py can fail: each rule meets a tree that breaks it, and one that does not."""
import pathlib
import re
import tempfile
import unittest
from unittest import mock

import house_rules
import rooms

HEAD = "// SPDX-License-Identifier: Apache-2.0\n// SPDX-FileCopyrightText: The pm authors\n"


class HouseRules(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name, "repository")
        self.root.mkdir()
        (self.root.parent / "files_with_lamp.txt").write_text("old.cpp\n")
        for where, what, value in ((rooms, "MAY_INCLUDE", {}), (house_rules, "LISTS", self.root.parent)):
            patch = mock.patch.object(where, what, value)
            patch.start()
            self.addCleanup(patch.stop)

    def write(self, name, text, head=HEAD):
        """A file, and in the table of rooms what it includes."""
        room = name.rsplit("/", 1)[0]
        if room.split("/")[0] in rooms.PARTS:
            others = {w.rsplit("/", 1)[0] for w in re.findall(r'include "([^"]+/[^"]+)"', text)} - {room, ".."}
            others |= set(rooms.MAY_INCLUDE.get(room, "").split())
            rooms.MAY_INCLUDE[room] = " ".join(sorted(others))
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(head + text)

    def one_breach(self, *parts):
        found = house_rules.breaches(self.root)
        self.assertEqual(len(found), 1, found)
        for part in parts:
            self.assertIn(part, found[0])

    def test_good_tree(self):
        self.write("integrator/values/v.h", "#pragma once\n#include <vector>\n")
        self.write("integrator/rays/r.cpp", "#include <embree3/rtcore.h>\n")
        self.write("scheduler/s.cpp", '#include "integrator/values/v.h"\n// never abort() here\n')
        self.write("plugin/include/pm_plugin.h", "")
        self.write("plugin/api/p.cpp", '#include "scheduler/s.h"\n#include "plugin/include/pm_plugin.h"\nPmrStatus s = PMR_OK;\n')
        self.write("plugin/session/p.cpp", '// PmrStatus\nconst char* s = "PMR_OK";\n')
        self.write("scheduler/s.h", "#pragma once\n")
        self.write("integrator/materials/m.cpp", "MaterialKind k; Phong p{3}; f(diffuse() * kInvPi);\n")
        self.write("host_shim/colour/h.cpp", '#include "plugin/include/pm_plugin.h"\n#include <OpenColorIO/x.h>\n')
        self.write("integrator/lights/l.cpp", "std::get_if<SpotLight>(&l);\n")
        self.assertEqual(house_rules.breaches(self.root), [])

    def test_layers(self):
        cases = [("integrator", "scheduler"), ("integrator", "plugin"), ("integrator", "host_shim"),
                 ("scheduler", "plugin"), ("scheduler", "integrator/light"), ("plugin", "host_shim"),
                 ("host_shim", "integrator/values"), ("host_shim", "plugin/session")]  # fmt: skip
        for who, whom in cases:
            with self.subTest(who=who, whom=whom):
                self.setUp()
                self.write(f"{whom}/x.h", "#pragma once\n")
                self.write(f"{who}/y.cpp", f'#include "{whom}/x.h"\n')
                self.one_breach(f"{who}/y.cpp:3", "may see only")

    def test_third_parties(self):
        cases = [("integrator/light", "embree3/rtcore.h"), ("plugin", "embree3/rtcore.h"),
                 ("integrator/rays", "opensubdiv/bfr/x.h"), ("integrator/x", "OpenImageIO/texture.h"),
                 ("plugin", "OpenColorIO/OpenColorIO.h")]  # fmt: skip
        for folder, what in cases:
            with self.subTest(folder=folder, what=what):
                self.setUp()
                self.write(f"{folder}/y.cpp", f"#include <{what}>\n")
                self.one_breach(f"{folder}/y.cpp:3", what)

    def test_forbidden(self):
        cases = [("host_shim", 'OIIO::attribute("threads", 1);'), ("plugin", "std::abort();"),
                 ("plugin", "tbb::global_control c(x, 1);"), ("integrator", "exit(1);"),
                 ("host_shim", "OCIO::SetCurrentConfig(c);"), ("integrator", "std::cerr << 1;"),
                 ("scheduler", 'printf("x");'), ("host_shim", "double d = std::stod(s);"),
                 ("integrator/transport/gather", "if (m.kind == MaterialKind::kMirror) return;"),
                 ("integrator/photons/map", "MaterialKind k;"),
                 ("integrator/photons/trace", "Phong lobe{3};"),
                 ("integrator/photons/trace", "if (!m_scene.intersect(ray, surface)) return;"),
                 ("integrator/transport/path", "Rgb out = bsdf.diffuse() * kInvPi * e;"),
                 ("integrator/scene", "std::get_if<SpotLight>(&l);"),
                 ("plugin", "if (l.kind == Light::Kind::kSpot) f();")]  # fmt: skip
        for folder, code in cases:
            with self.subTest(code=code):
                self.setUp()
                self.write(f"{folder}/y.cpp", f"/* a\n comment */\n{code}\n")
                self.one_breach(f"{folder}/y.cpp:5")

    def test_brute_force(self):
        self.write("tests/integrator/brute/brute_force.cpp",
                   '#include "integrator/scene/scene.h"\n#include <cmath>\n#include "integrator/paths/segment.h"\n')
        self.one_breach("brute_force.cpp:5", "integrator/paths/segment.h")

    def test_interface_names(self):
        for room, code in [("session", "PmrStatus s;"), ("storage", "return PMR_OK;"),
                           ("values", "pmrGetApi(1, &api);")]:  # fmt: skip
            with self.subTest(code=code):
                self.setUp()
                self.write(f"plugin/{room}/y.cpp", f"/* PmrApi */\n{code}\n")
                self.one_breach(f"plugin/{room}/y.cpp:4", "allowed only in plugin/api/")

    def test_cycle_between_subfolders(self):
        self.write("integrator/a/a.h", '#pragma once\n#include "integrator/b/b.h"\n')
        self.write("integrator/b/b.h", '#pragma once\n#include "integrator/c/c.h"\n')
        self.write("integrator/c/c.h", '#pragma once\n#include "integrator/a/a.h"\n')
        self.one_breach("integrator/a -> integrator/b -> integrator/c -> integrator/a")

    def test_cycle_between_parents(self):
        self.write("integrator/a/x/1.h", '#pragma once\n#include "integrator/b/y/2.h"\n')
        self.write("integrator/b/y/2.h", "#pragma once\n")
        self.write("integrator/b/z/3.h", '#pragma once\n#include "integrator/a/w/4.h"\n')
        self.write("integrator/a/w/4.h", "#pragma once\n")
        self.one_breach("integrator/a -> integrator/b -> integrator/a")

    def test_rooms(self):
        self.write("integrator/a/a.h", '#pragma once\n#include "integrator/b/b.h"\n')
        self.write("integrator/b/b.h", "#pragma once\n")
        rooms.MAY_INCLUDE["integrator/a"] = "c"
        self.write("integrator/c/c.h", "#pragma once\n")
        found = house_rules.breaches(self.root)
        self.assertEqual(len(found), 2, found)
        self.assertIn("integrator/a/a.h:4: includes integrator/b/b.h; by tests/house/rooms.py integrator/a "
                      "may include integrator/c", found[0])  # fmt: skip
        self.assertIn("integrator/a does not include integrator/c", found[1])
        rooms.MAY_INCLUDE.update({"integrator/a": "b", "integrator/gone": ""})
        self.one_breach("no room integrator/gone")
        del rooms.MAY_INCLUDE["integrator/gone"], rooms.MAY_INCLUDE["integrator/b"]
        self.one_breach("integrator/b: is a room without a row")

    def test_a_light_is_called_light(self):
        for code in ("int lampCount;", "struct Lamp {};", "int first_lamp;", "kLamps"):
            with self.subTest(code=code):
                self.setUp()
                self.write("integrator/a/new.cpp", code)
                self.one_breach("integrator/a/new.cpp: has the word lamp")
        self.setUp()
        self.write("integrator/a/old.cpp", "int lampCount;")
        self.write("integrator/a/new.cpp", 'clamp(kClampMost, "lamp"); // lamp')
        self.assertEqual(house_rules.breaches(self.root), [])
        self.write("tests/house/files_with_lamp.txt", "")
        self.write("integrator/a/old.cpp", "int lightCount;")
        self.one_breach("old.cpp has no lamp any more")

    def test_heads_and_places(self):
        self.write("integrator/a.h", "#pragma once\n", head="")
        self.one_breach("integrator/a.h:1", "SPDX")
        self.setUp()
        self.write("integrator/a.h", "")
        self.one_breach("#pragma once")
        self.setUp()
        self.write("core/a.h", "")
        self.one_breach("core: does not belong")
        self.setUp()
        self.write("integrator/a.cpp", '#include "../b.h"\n')
        self.one_breach("named from the repository's root")

    def test_copy_of_shared(self):
        self.write("tests/data/x.txt", "y" * 100)
        (self.root.parent / "shared").mkdir()
        (self.root.parent / "shared" / "other.txt").write_text(HEAD + "y" * 100)
        self.one_breach("tests/data/x.txt", "../shared/other.txt")


if __name__ == "__main__":
    unittest.main()
