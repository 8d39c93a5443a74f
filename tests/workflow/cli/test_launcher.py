"""The launcher on a small project of its own, so that installing and building can fail, race and be counted."""
import os
import pathlib
import shutil
import subprocess
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]

CMAKE = """cmake_minimum_required(VERSION 3.22)
project(tiny CXX)
enable_testing()
file(GLOB sources CONFIGURE_DEPENDS engine/*.cpp)
add_executable(loam-bin ${sources})
add_custom_command(TARGET loam-bin POST_BUILD COMMAND ${CMAKE_COMMAND} -E echo linked >> ${CMAKE_BINARY_DIR}/links.txt)
add_test(NAME good COMMAND ${CMAKE_COMMAND} -E true)
add_test(NAME also_good COMMAND ${CMAKE_COMMAND} -E true)
if(EXISTS ${CMAKE_SOURCE_DIR}/tests/fail)
  add_test(NAME bad COMMAND ${CMAKE_COMMAND} -E false)
endif()
add_test(NAME slow COMMAND ${CMAKE_COMMAND} -E true)
set_tests_properties(slow PROPERTIES LABELS long)
"""

MAIN = """#include <cstdio>
#include <unistd.h>
const char* answer();
int main(int argc, char** argv) {
    char folder[4096];
    std::printf("%s %s", answer(), getcwd(folder, sizeof folder));
    for (int i = 1; i < argc; ++i) std::printf("|%s", argv[i]);
    std::printf("\\n");
    return argc > 1 && argv[1][0] == 'x' ? 130 : 0;
}
"""

ANSWER = 'const char* answer() { return "first"; }\n'


class LauncherTest(unittest.TestCase):
    def setUp(self):
        base = pathlib.Path(tempfile.mkdtemp(prefix="loam launcher "))
        self.addCleanup(shutil.rmtree, base, ignore_errors=True)
        os.chmod(base, 0o755)
        self.root = base / "a tree"
        self.tools = base / "tools"
        self.tools.mkdir()
        for folder in ("engine", "lab_data/sets", "tests"):
            (self.root / folder).mkdir(parents=True)
        shutil.copy(ROOT / "loam", self.root / "loam")
        shutil.copy(ROOT / "CMakePresets.json", self.root)
        (self.root / "CMakeLists.txt").write_text(CMAKE)
        (self.root / "packages.txt").write_text("# build\ncmake\n\n# test: more\nninja-build\n")
        (self.root / "engine/main.cpp").write_text(MAIN)
        (self.root / "engine/answer.cpp").write_text(ANSWER)

    def start(self, *words, **options):
        environment = {**os.environ, "PATH": f"{self.tools}:{os.environ['PATH']}"}
        return subprocess.Popen([options.pop("launcher", self.root / "loam"), *words], stdin=subprocess.DEVNULL,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment, **options)

    def run_it(self, *words, **options):
        process = self.start(*words, **options)
        output, error = process.communicate(timeout=120)
        return subprocess.CompletedProcess(words, process.returncode, output, error)

    def links(self):
        """How often the program was linked."""
        return len((self.root / "build/release/links.txt").read_text().splitlines())

    def tool(self, name, script):
        path = self.tools / name
        path.write_text(f"#!/bin/sh\n{script}\n")
        path.chmod(0o755)


class Building(LauncherTest):
    def test_first_and_second_start(self):
        first = self.run_it("check", "a b", "*", cwd=self.tools)
        self.assertEqual((first.returncode, first.stdout), (0, f"first {self.tools}|check|a b|*\n"), first.stderr)
        self.assertIn("loam: built in", first.stderr)
        seconds = []
        for _ in range(5):
            before = time.monotonic()
            second = self.run_it("check")
            seconds.append(time.monotonic() - before)
            self.assertEqual((second.returncode, second.stderr), (0, ""))
        self.assertLess(min(seconds), 0.2)
        self.assertEqual(self.links(), 1)

    def test_the_programs_exit_status_is_the_launchers(self):
        self.assertEqual(self.run_it("x").returncode, 130)

    def test_through_a_symbolic_link(self):
        link = self.tools / "my loam"
        link.symlink_to(self.root / "loam")
        self.assertEqual(self.run_it("check", launcher=link, cwd="/").stdout, "first /|check\n")

    def test_changed_added_and_deleted_sources_are_seen(self):
        answer = self.root / "engine/answer.cpp"
        self.run_it()
        answer.write_text(ANSWER.replace("first", "second"))
        self.assertTrue(self.run_it().stdout.startswith("second"))
        answer.unlink()
        missing = self.run_it()
        self.assertEqual((missing.returncode, missing.stdout), (1, ""))
        (self.root / "engine/other.cpp").write_text(ANSWER.replace("first", "third"))
        self.assertTrue(self.run_it().stdout.startswith("third"))
        (self.root / "lab_data/sets/new.csv").write_text("data are no sources\n")
        links = self.links()
        self.assertEqual(self.run_it().stderr, "")
        self.assertEqual(self.links(), links)

    def test_a_tree_that_has_moved(self):
        self.run_it()
        moved = self.root.parent / "moved"
        self.root.rename(moved)
        self.root = moved
        self.assertTrue(self.run_it().stdout.startswith("first"))
        self.assertEqual(self.run_it().stderr, "")

    def test_a_build_that_fails_says_why(self):
        (self.root / "engine/answer.cpp").write_text("const char* answer() { return nonsense; }\n")
        answer = self.run_it("check")
        self.assertEqual((answer.returncode, answer.stdout), (1, ""))
        self.assertIn("nonsense", answer.stderr)
        self.assertIn("loam: the build failed (whole log:", answer.stderr)
        self.assertEqual(self.run_it("check").returncode, 1)  # and it is not taken for done

    def test_two_at_once_build_once(self):
        processes = [self.start("check") for _ in range(3)]
        for process in processes:
            output, error = process.communicate(timeout=120)
            self.assertEqual((process.returncode, output.split()[0]), (0, "first"), error)
        self.assertEqual(self.links(), 1)


class Packages(LauncherTest):
    def setUp(self):
        super().setUp()
        with open(self.root / "packages.txt", "w", encoding="utf-8") as packages:
            packages.write("cmake\nloam-missing-one  # not there\nloam-missing-two\n# test: more\nloam-missing-three\n")
        self.calls = self.tools / "calls.txt"
        self.tool("apt-get", f'echo noise; echo "$@" >> "{self.calls}"')

    def install(self, *words):
        """Starts as root or, through a sudo that asks nothing, as anyone."""
        self.tool("sudo", 'test "$1" = -n && shift; exec "$@"')
        return self.run_it(*words)

    def test_what_is_missing_is_installed(self):
        answer = self.install("check")
        self.assertEqual(answer.returncode, 0, answer.stderr)
        self.assertNotIn("noise", answer.stdout + answer.stderr)
        calls = self.calls.read_text().splitlines()
        self.assertIn("update", calls[0])
        self.assertIn("install --no-install-recommends loam-missing-one loam-missing-two", calls[1])
        self.assertNotIn("cmake", calls[1])
        self.assertNotIn("loam-missing-three", calls[1])

    def test_the_tests_need_more(self):
        self.assertEqual(self.install("test").returncode, 0)
        self.assertIn("loam-missing-three", self.calls.read_text())

    def test_an_installation_that_fails(self):
        self.tool("apt-get", 'echo "E: Unable to locate package"; exit 100')
        answer = self.install("check")
        self.assertEqual((answer.returncode, answer.stdout), (1, ""))
        self.assertIn("E: Unable to locate package", answer.stderr)
        self.assertIn("apt-get install --no-install-recommends loam-missing-one loam-missing-two", answer.stderr)

    def test_without_root_it_says_what_to_install(self):
        self.tool("sudo", "echo a password is required >&2; exit 1")
        user = {}
        if os.geteuid() == 0:
            user = {"user": 65534, "group": 65534, "extra_groups": []}
            for path in (self.root, *self.root.rglob("*")):
                os.chown(path, 65534, 65534)
        answer = self.run_it("check", **user)
        self.assertEqual((answer.returncode, answer.stdout), (1, ""))
        self.assertIn("sudo apt-get install --no-install-recommends loam-missing-one loam-missing-two\n", answer.stderr)
        self.assertFalse(self.calls.exists())


class Testing(LauncherTest):
    def last_lines(self, answer):
        return answer.stdout.splitlines()[-2:]

    def test_all_passed(self):
        answer = self.run_it("test")
        self.assertEqual(answer.returncode, 0, answer.stderr)
        self.assertEqual(self.last_lines(answer), ["100% tests passed, 0 tests failed out of 2", "2 passed, 0 failed"])

    def test_long_ones_on_request_and_a_pattern(self):
        self.assertEqual(self.last_lines(self.run_it("test", "--long"))[1], "3 passed, 0 failed")
        self.assertEqual(self.last_lines(self.run_it("test", "also"))[1], "1 passed, 0 failed")
        self.assertEqual(self.run_it("test", "nothing-like-it").returncode, 1)

    def test_a_failure(self):
        (self.root / "tests/fail").touch()
        answer = self.run_it("test")
        self.assertEqual(answer.returncode, 1)
        self.assertEqual(self.last_lines(answer), ["67% tests passed, 1 tests failed out of 3", "2 passed, 1 failed"])

    def test_an_unknown_preset(self):
        answer = self.run_it("test", "--preset", "fast")
        self.assertEqual((answer.returncode, answer.stdout), (2, ""))
        self.assertIn("'fast' is not a preset", answer.stderr)

    def test_help_builds_nothing(self):
        answer = self.run_it("test", "--help")
        self.assertEqual(answer.returncode, 0)
        self.assertIn("example: loam test", answer.stdout)
        self.assertFalse((self.root / "build").exists())


if __name__ == "__main__":
    unittest.main()
