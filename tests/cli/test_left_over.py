"""What the tests of clean endings call left over."""

import subprocess
import sys
import uuid
from pathlib import Path

import pytest
from bench_process import orphans, shared_memory

HOLD = "import sys; file = open(sys.argv[1], 'rb'); print(1, flush=True); sys.stdin.read()"


@pytest.mark.skipif(not Path("/dev/shm").is_dir(), reason="no shared memory here")
def test_a_file_of_another_living_process_is_not_left_over():
    file = Path("/dev/shm", f"bench-test-{uuid.uuid4().hex}")
    file.write_bytes(b"0")
    try:
        command = [sys.executable, "-c", HOLD, str(file)]
        with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as other:
            assert other.stdout is not None
            other.stdout.readline()
            assert file.name in shared_memory()
            assert orphans({file.name}) == []
        assert orphans({file.name}) == [file.name]
    finally:
        file.unlink()
    assert orphans({file.name}) == []
