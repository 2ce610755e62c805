"""The checks of this folder can fail: each rule is broken once in a small tree, and must be named."""

import pathlib
import tempfile
import unittest

import check_layers
import check_libm
import check_links
import check_loaded
import check_papers
import check_performance_page
import check_prose
import check_sentences
import check_unity
import check_words

LAYERS = """core_base |  | core/base/base.h core/base/base.cpp
core_scene | core_base | core/scene/scene.h core/scene/trace/tracer.cpp
schema_messages |  | schema/job.pb.h
schema_service | schema_messages | schema/farm.grpc.pb.h
worker | core_scene schema_service | worker/job.cpp
irsig | worker | cli/main.cpp
"""
GOOD = {
    "core/base/base.h": "#pragma once\n",
    "core/base/base.cpp": '#include "core/base/base.h"\n#include <vector>\n#include "absl/status/status.h"\n',
    "core/scene/scene.h": "",
    "core/scene/trace/embree.h": '#include <embree3/rtcore.h>\n#include "core/base/base.h"\n',
    "worker/job.cpp": '#include "core/base/base.h"\n#include "schema/job.pb.h"\n#include "schema/farm.grpc.pb.h"\n',
    "cli/main.cpp": "#include <CLI/CLI.hpp>\n",
    "tests/unit/base_test.cpp": '#include "core/base/base.h"\n#include <sqlite3.h>\n',
}


class TreeTest(unittest.TestCase):
    def tree(self, changes):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        root = pathlib.Path(folder.name)
        for name, text in {**GOOD, **changes}.items():
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text)
        return root

    def layers(self, changes, layers=LAYERS):
        return check_layers.check(self.tree(changes), layers)

    def words(self, changes):
        return check_words.check(self.tree(changes))


class Layers(TreeTest):
    def expect(self, finding, changes, layers=LAYERS):
        self.assertEqual(self.layers(changes, layers), [finding])

    def test_good_tree(self):
        self.assertEqual(self.layers({}), [])

    def test_include_upwards(self):
        self.expect("core/base/base.cpp:2: core_base may not include core_scene (core/scene/scene.h)",
                    {"core/base/base.cpp": '\n  #  include "core/scene/scene.h"\n'})

    def test_angle_brackets_are_no_way_around(self):
        self.expect("core/base/base.cpp:1: core_base may not include core_scene (core/scene/scene.h)",
                    {"core/base/base.cpp": "#include <core/scene/scene.h>\n"})

    def test_generated_messages_in_core(self):
        self.expect("core/scene/scene.h:1: core_scene may not include schema_messages (schema/job.pb.h)",
                    {"core/scene/scene.h": '#include "schema/job.pb.h"\n'})

    def test_generated_service_belongs_to_its_own_module(self):
        layers = LAYERS.replace("core_scene schema_service", "core_scene schema_messages")
        self.expect("worker/job.cpp:3: worker may not include schema_service (schema/farm.grpc.pb.h)", {}, layers)

    def test_program_may_not_reach_past_its_modules(self):
        layers = LAYERS.replace("irsig | worker", "irsig | core_base")
        self.expect("cli/main.cpp:1: irsig may not include core_scene (core/scene/scene.h)",
                    {"cli/main.cpp": '#include "core/scene/scene.h"\n'}, layers)

    def test_file_of_no_module(self):
        self.expect("core/base/extra.cpp: no module owns this file",
                    {"core/base/extra.cpp": ""})

    def test_header_in_a_folder_of_no_module(self):
        self.expect("core/wing/wing.h: no module owns this file", {"core/wing/wing.h": ""})

    def test_private_header(self):
        private = {"core/base/inner.h": "", "core/base/base.cpp": '#include "core/base/inner.h"\n'}
        self.assertEqual(self.layers(private), [])
        self.expect("core/scene/scene.h:1: core/base/inner.h is a private header of core_base",
                    {**private, "core/scene/scene.h": '#include "core/base/inner.h"\n'})

    def test_include_of_file_of_no_module(self):
        self.expect("worker/job.cpp:1: no module owns tests/unit/fixture.h",
                    {"worker/job.cpp": '#include "tests/unit/fixture.h"\n', "tests/unit/fixture.h": ""})

    def test_include_relative_to_the_folder(self):
        self.expect('core/base/base.cpp:1: "base.h" is relative to the folder, not to the root',
                    {"core/base/base.cpp": '#include "base.h"\n'})

    def test_dependency_on_no_module(self):
        self.expect("worker: depends on core_wing, which is no module", {},
                    LAYERS.replace("core_scene schema_service", "core_scene schema_service core_wing"))

    def test_each_library_has_one_place(self):
        for header in ("embree3/rtcore.h", "OpenImageIO/imageio.h", "sqlite3.h", "GeographicLib/Geodesic.hpp",
                       "erfa.h", "grpcpp/server.h", "toml++/toml.h", "yaml-cpp/yaml.h", "netcdf.h", "CLI/CLI.hpp",
                       "spdlog/spdlog.h", "openvdb/openvdb.h", "google/protobuf/message.h"):
            with self.subTest(header=header):
                findings = self.layers({"core/base/base.h": f"#include <{header}>\n"})
                self.assertEqual(len(findings), 1)
                self.assertIn(f"core/base/base.h:1: {header} may be included in ", findings[0])

    def test_judges_are_for_the_self_test_alone(self):
        layers = (LAYERS.replace("irsig | worker | cli/main.cpp", "irsig | worker verify_cases | cli/main.cpp cli/selftest.cpp")
                  + "verify_cases | core_scene | verify/cases/case.h verify/cases/case.cpp\n")
        good = {"verify/cases/case.h": "", "verify/cases/case.cpp": '#include "verify/cases/case.h"\n',
                "cli/selftest.cpp": '#include "verify/cases/case.h"\n', "tests/unit/base_test.cpp": '#include "verify/cases/case.h"\n'}
        self.assertEqual(self.layers(good, layers), [])
        self.expect("cli/main.cpp:1: verify/cases/case.h may be included in verify/, cli/selftest.cpp, tests/ only",
                    {**good, "cli/main.cpp": '#include "verify/cases/case.h"\n'}, layers)
        self.expect("worker: may not depend on verify_cases: verify/ is for verify/, cli/selftest.cpp, tests/ only", good,
                    layers.replace("core_scene schema_service", "core_scene schema_service verify_cases"))

    def test_the_coordinator_reaches_no_physics(self):
        layers = LAYERS.replace("irsig | worker", "coordinator | jobs | \njobs | core_base | \nirsig | worker")
        self.assertEqual(self.layers({}, layers), [])
        self.expect("coordinator: may not reach core_scene: of core only core_accuracy, core_base, core_effects", {},
                    layers.replace("jobs | core_base", "jobs | core_scene"))

    def test_one_name_for_two_types(self):
        first = {"core/base/base.h": "namespace irsig {\nstruct Row {\n"}
        for text in ("class Row {\n", "enum class Row { kA };\n", "struct Row final : Base {\n", "struct Row : std::any {\n"):
            self.expect("core/scene/scene.h:2: irsig::Row is a type of core/base/base.h:2 too",
                        {**first, "core/scene/scene.h": "namespace irsig {\n" + text})
        for text in ("namespace irsig::other {\nstruct Row {\n", "namespace irsig {\nstruct Row;\nstruct Rows {\n",
                     "namespace irsig {\nstruct Field::Row {\n"):
            self.assertEqual(self.layers({**first, "core/scene/scene.h": text}), [])

    def test_four_files_that_include_each_other(self):
        def circle(length):
            names = [f"core/base/{letter}" for letter in "abcd"[:length]]
            headers = {f"{name}.h": f'#include "{names[0]}.h"\n' for name in names}
            return headers | {f"{name}.cpp": f'#include "{there}.h"\n' for name, there in zip(names, names[1:])}

        layers = LAYERS.replace("core/base/base.cpp", "core/base/base.cpp " + " ".join(circle(4)))
        self.assertEqual(self.layers(circle(3), layers), [])
        self.expect("core/base/a: 4 files include each other, at most 3 may: "
                    "core/base/a core/base/b core/base/c core/base/d", circle(4), layers)

    def test_ray_tracer_in_one_file_only(self):
        self.assertEqual(len(self.layers({"core/scene/scene.h": "#include <embree3/rtcore.h>\n"})), 1)
        self.assertEqual(len(self.layers({"tests/unit/base_test.cpp": "#include <embree3/rtcore.h>\n"})), 1)


class Words(TreeTest):
    def test_good_tree(self):
        self.assertEqual(self.words({"ops/run.sh": "cd ${HOME}/work; ls build/tmp $root/work/x"}), [])

    def test_path_of_a_machine(self):
        for path in ("/" + "work/x", "/home/someone", "/root/x"):
            with self.subTest(path=path):
                self.assertEqual(len(self.words({"docs/a.md": f"see\n`{path}`\n"})), 1)

    def test_unfinished(self):
        for mark in ("TODO", "FIXME"):
            with self.subTest(mark=mark):
                self.assertEqual(self.words({"cli/main.cpp": f"// {mark}: later\n"}),
                                 [f"cli/main.cpp:1: unfinished work: {mark}"])

    def test_empty_names(self):
        for name in ("core/util/a.cpp", "core/common.h", "view/string_helpers.cpp", "cli/job_manager.h", "misc/a.txt"):
            with self.subTest(name=name):
                self.assertEqual(len(self.words({name: ""})), 1)

    def test_former_names(self):
        self.assertEqual(self.words({"core/base/base.cpp": "double target_missed;\n"}),
                         ["core/base/base.cpp:1: target_missed is a former name; use accuracy_not_reached"])
        self.assertEqual(self.words({"core/base/base.cpp": "double target_missed_by;\n",
                                     "schema/README.md": "target_missed\n"}), [])

    def test_function_comments_begin_with_a_verb(self):
        for text in ("// The mean of a.\n[[nodiscard]] double mean(A a);\n", "struct A {\n  // True if empty.\n  bool empty() const;\n};\n",
                     "// INVALID_ARGUMENT: none.\nstatic absl::StatusOr<A> make();\n"):
            findings = self.words({"core/base/base.h": text})
            self.assertEqual(len(findings), 1, text)
            self.assertIn("begins without a verb", findings[0])
        for text in ("// Returns the mean.\n[[nodiscard]] double mean(A a);\n", "// The mean of a.\ndouble mean = f(a);\n",
                     "// Like mean().\ndouble median(A a);\n", "//   a  not empty\ndouble mean(A a);\n",
                     "// Mean.\nstruct A {};\n", "// Mean.\n\ndouble f();\n", "struct A {\n  // All are kept.\n  explicit A(int b);\n};\n"):
            self.assertEqual(self.words({"core/base/base.h": text}), [], text)

    def test_fragments(self):
        for text in ("// Of a row: its error.\n", "struct A {\n  double a;  // What it is, in W.\n};\n",
                     "void f();\n\n  // Whether it is so.\nbool g();\n", "// The same for\n// all.\n"):
            with self.subTest(text=text):
                findings = self.words({"core/base/base.h": text})
                self.assertEqual(len(findings), 1)
                self.assertIn("opens as a fragment", findings[0])
        for text in ("// Returns the error\n// Of a row.\n", "double a;  // error\n           // What is\n", "// Often so.\n"):
            with self.subTest(text=text):
                self.assertEqual(self.words({"core/base/base.h": text}), [])
        self.assertEqual(len(self.words({"tests/unit/base.cpp": "// Of a row.\n"})), 1)
        self.assertEqual(self.words({"tests/unit/base.h": "// Mean.\ndouble f();\n"}), [])

    def test_long_lines(self):
        self.assertEqual(self.words({"docs/a.md": "a " * 60 + "\n"}), [])
        self.assertEqual(len(self.words({"docs/a.md": "a " * 60 + "a\n"})), 1)
        self.assertEqual(self.words({"docs/a.md": "| a" * 60 + "|\n# " + "b" * 130 + "\n"}), [])

    def test_stale_paths(self):
        for name, text in (("docs/a.md", "see `core/base/gone.h`\n"), ("core/base/b.cpp", "// core/base/gone.h\n"),
                           ("ops/a.sh", "# as core/base/gone.h\n"), ("docs/a.md", "`values/gone.csv`\n"),
                           ("docs/a.md", "`core/base/gone.*`\n")):
            with self.subTest(name=name, text=text):
                self.assertEqual(len(self.words({name: text})), 1)
        self.assertEqual(self.words({"docs/a.md": "`core/base/base.*`, `core/base/base.h`, `job.cpp`, out/a.csv\n",
                                     "worker/README.md": "`worker/job.cpp`, `../core/base/base.h`\n",
                                     "core/base/b.cpp": 'open("core/base/gone.h");\n'}), [])


class Links(TreeTest):
    def links(self, changes):
        return check_links.check(self.tree(changes))

    def test_good_links(self):
        self.assertEqual(self.links({"docs/a.md": "# A `b`: c\n[b](b.md#one-1) [c](#a-b-c) [d](https://x.y) `[e](f)`\n\n    [g](h)\n",
                                     "docs/b.md": "## One\n## One\n"}), [])

    def test_dead_links(self):
        self.assertEqual(self.links({"docs/a.md": "![b](b.svg)\n"}), ["docs/a.md:1: links to b.svg, which does not exist"])
        self.assertEqual(self.links({"docs/a.md": "\n[b](b.md#two)\n", "docs/b.md": "# One\n"}),
                         ["docs/a.md:2: docs/b.md has no heading #two"])


class Sentences(TreeTest):
    def sentences(self, text):
        return check_sentences.check(self.tree({"docs/howto/a.md": text}))

    def test_short_sentences(self):
        self.assertEqual(self.sentences("# " + "a " * 50 + "\n\nOne two, three, four, five, six, seven, eight.\n- " + "a " * 22 + "\n\n    " + "a " * 50 + "\n"), [])

    def test_long_sentences(self):
        self.assertEqual(len(self.sentences(("a " * 18 + ". ") * 40 + "\n\n" + "a\n" * 41)), 1)
        self.assertEqual(len(self.sentences("a " * 23 + ". " + "`a b` " * 23)), 1)

    def test_fragments(self):
        self.assertEqual(len(self.sentences("Short. " * 40)), 1)
        self.assertEqual(self.sentences(("a " * 15 + ". ") * 4), [])


class Prose(TreeTest):
    def prose(self, changes):
        return check_prose.check(self.tree(changes))

    def test_tables_code_and_records_do_not_count(self):
        many = "a " * check_prose.MOST
        self.assertEqual(self.prose({"docs/a.md": f"| {many}|\n\n```\n{many}\n```\n\n    {many}\n", "docs/decisions/b.md": many,
                                     "README.md": many}), [])

    def test_all_pages_together_have_a_limit(self):
        half = "a " * (check_prose.MOST // 2)
        self.assertEqual(self.prose({"docs/a.md": half, "docs/b/c.md": half}), [])
        self.assertEqual(len(self.prose({"docs/a.md": half + "- a\n    a\n", "docs/b/c.md": half})), 1)


class Loaded(unittest.TestCase):
    def test_image_library_is_found(self):
        line = "\tlibOpenImageIO.so.2.4 => /lib/x86_64-linux-gnu/libOpenImageIO.so.2.4 (0x00007f)\n"
        self.assertEqual(check_loaded.apart(line), ["libOpenImageIO.so"])
        self.assertEqual(check_loaded.apart("\tlibsqlite3.so.0 => /lib/libsqlite3.so.0 (0x0)\n"), [])


class Libm(unittest.TestCase):
    FINGERPRINT = [("arithmetic_fingerprint.cpp.o", name) for name in ("exp", "sincosf")]

    def test_covered(self):
        self.assertEqual(check_libm.check(self.FINGERPRINT + [("a.cpp.o", "exp"), ("b.cpp.o", "sinf@GLIBC_2.2.5"), ("b.cpp.o", "cosf"),
                                                              ("b.cpp.o", "sqrt"), ("b.cpp.o", "fmod"), ("b.cpp.o", "memcpy")]), [])

    def test_not_covered(self):
        self.assertEqual(check_libm.check(self.FINGERPRINT + [("a.cpp.o", "exp"), ("b.cpp.o", "sincosf"), ("c.cpp.o", "csqrt")]),
                         ["c.cpp.o calls csqrt: add it to core/base/arithmetic_fingerprint.cpp"])

    def test_not_called(self):
        self.assertEqual(check_libm.check(self.FINGERPRINT + [("a.cpp.o", "expf"), ("a.cpp.o", "exp"), ("b.cpp.o", "cosf")]),
                         ["a.cpp.o calls expf: add it to core/base/arithmetic_fingerprint.cpp",
                          "core/base/arithmetic_fingerprint.cpp covers sinf, which nothing calls: remove it"])


class PerformancePage(unittest.TestCase):
    HEADER = "inline constexpr int kPhysicsVersion = 17;"

    def page(self, line):
        return f"# Performance\n{check_performance_page.BEGIN}\n{line}\n| a |\n"

    def test_of_now(self):
        self.assertEqual(check_performance_page.complaint(self.page("Physics version 17, 2026-11-27, 2 x CPU"), self.HEADER), "")

    def test_of_before(self):
        self.assertIn("version 16", check_performance_page.complaint(self.page("Physics version 16, 2026-11-27, 2 x CPU"), self.HEADER))

    def test_without(self):
        self.assertIn("does not say", check_performance_page.complaint(self.page("One run each"), self.HEADER))
        self.assertIn("one line", check_performance_page.complaint("# Performance\n", self.HEADER))


class Papers(unittest.TestCase):
    SCRIPT = "((${#parts[@]} > 0)) || parts=(ship cavity)\n"
    HEAD = "| where | finding | paper | ours | agreement | part | remark |\n|---|---|---|---|---|---|---|\n"

    def complaints(self, ship, cavity="| 1 | a | 2 | 2 | yes | `cavity` |  |\n", more=""):
        tables = {"ship": ship, "cavity": cavity}
        return check_papers.complaints("".join(f"<!-- begin papers {p} -->\n{self.HEAD}{t}<!-- end papers {p} -->\n" for p, t in tables.items())
                                       + more, self.SCRIPT)

    def test_good(self):
        self.assertEqual(self.complaints("| 1 | a | 2 | 3 | no | `ship` | because |\n"), [])

    def test_row_of_another_part(self):
        self.assertIn("in the table of `ship`", self.complaints("| 1 | a | 2 | 2 | yes | `cavity` |  |\n")[0])

    def test_row_without_a_reason(self):
        for agreement in ("no", "not compared", "nearly"):
            self.assertIn(f"agreement `{agreement}`", self.complaints(f"| 1 | a | 2 | 3 | {agreement} | `ship` |  |\n")[0])

    def test_empty_table(self):
        self.assertIn("is empty", self.complaints("")[0])

    def test_cells(self):
        self.assertIn("6 cells", self.complaints("| 1 | 2 | 2 | yes | `ship` |  |\n")[0])

    def test_marks(self):
        self.assertIn("no such part", self.complaints("| 1 | a | 2 | 2 | yes | `ship` |  |\n", more="<!-- begin papers moon -->\n")[0])
        self.assertEqual(len(check_papers.complaints("", self.SCRIPT)), 2)


class Unity(TreeTest):
    ONE = "namespace irsig {\nnamespace {\n%s\n}  // namespace\n}  // namespace irsig\n"
    TARGET = "core_base | core/base/base.cpp core/base/other.cpp\n"

    def unity(self, a, b, batches=TARGET):
        return check_unity.check(self.tree({"core/base/base.cpp": self.ONE % a, "core/base/other.cpp": self.ONE % b}), batches)

    def test_equal_names(self):
        for a in ("double area(double x) { return x; }", "std::vector<Pair<int, int>> area(const F<void(int)>& f) {\n}",
                  "struct area {\n  int x;\n};", "using area = int;", "constexpr double kOther = 1, area = 2;",
                  "const char* const area[] = {\"{\", \"}\"};", "template <typename T>\nT area(T x) {\n  return x;\n}",
                  "enum class area { kOne };", "std::pair<int, int> area();", "constexpr int kMany = 1'000;\nint area() { return 'a'; }"):
            with self.subTest(a=a):
                self.assertEqual(self.unity(a, "double area = 1;"),
                                 ["core/base/other.cpp: area is a name in an anonymous namespace of core/base/base.cpp, too: "
                                  "a release compiles both as one (core_base); rename one of them"])

    def test_other_names(self):
        for a in ("double other() {\n  double area = 1;\n  return area;\n}", "// double area() {\n", "double Box::area() {\n}",
                  "struct Box {\n  double area() const;\n};", "bool operator<(Box a, Box b) {\n}", "#define X double area() {",
                  "static_assert(area(1) == 2);", "const char* kText = R\"(\ndouble area() {\n)\";", "constexpr int kTwo = 2 * area;"):
            with self.subTest(a=a):
                self.assertEqual(self.unity(a, "double area = 1;\nbool operator<(Ball a, Ball b) {\n}"), [])

    def test_equal_aliases_may_stand(self):
        self.assertEqual(self.unity("using Cell = std::array<int, 3>;", "using Cell = std::array<int,\n 3>;"), [])
        self.assertEqual(len(self.unity("using Cell = std::array<int, 3>;", "using Cell = std::array<int, 2>;")), 1)

    def test_targets_apart(self):
        batches = "core_base | core/base/base.cpp\ncore_other | core/base/other.cpp\n"
        self.assertEqual(self.unity("double area = 1;", "double area = 1;", batches), [])


if __name__ == "__main__":
    unittest.main()
