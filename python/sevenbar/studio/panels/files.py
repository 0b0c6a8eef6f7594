"""Opening and saving: the gallery, files of one's own, and what can be taken home."""

from __future__ import annotations

import threading
import traceback
from typing import Any

import viser

from sevenbar.description.files import decoded, toml_text
from sevenbar.description.gallery import names, title
from sevenbar.errors import SevenbarError
from sevenbar.studio.panels.controls import Alert, on_change, put
from sevenbar.studio.panels.downloads import DOWNLOADS, Scene
from sevenbar.studio.state.session import Session
from sevenbar.studio.state.shelf import ENDING, ChangedError, Shelf
from sevenbar.studio.worker import Worker

#: What the list of the gallery says before something is chosen.
CHOOSE = "choose one"


class FilesPanel:
    """Everything that comes into the studio and goes out of it, through the browser."""

    def __init__(
        self, client: viser.ClientHandle, worker: Worker, session: Session, shelf: Shelf | None
    ) -> None:
        """`shelf` has the files that may be saved to; without one everything goes through the browser."""
        gui = client.gui
        self._client, self._worker, self._session, self._shelf = client, worker, session, shelf
        self._names = {f"{name}: {title(name)}": name for name in names()}
        with gui.add_folder("Open"):
            self._gallery = gui.add_dropdown("gallery", (CHOOSE, *self._names))
            self._open = gui.add_upload_button(
                "Open a TOML file",
                color="gray",
                icon=viser.Icon.FOLDER_OPEN,
                mime_type=".toml,.csv,.tsv,.xlsx,text/plain",
            )
            self._alert = Alert(gui)
        with gui.add_folder("Save"):
            self._file = gui.add_text("file", "", visible=shelf is not None)
            if shelf is not None:
                self._file.hint = f"in {shelf.folder}"
            keep = gui.add_button("Save", icon=viser.Icon.DEVICE_FLOPPY, visible=shelf is not None)
            self._kept = Alert(gui)
            self._replace = gui.add_button("Replace it", color="red", visible=False)
            save = gui.add_button("Download as TOML", color="gray", icon=viser.Icon.DOWNLOAD)
            self._kind = gui.add_dropdown("export", tuple(DOWNLOADS))
            write = gui.add_button("Export", icon=viser.Icon.DOWNLOAD)
            self._unsaved = Alert(gui)
        on_change(self._gallery, worker, "open", self._chosen)
        self._open.on_upload(self._uploaded)
        save.on_click(lambda _: worker.ask("save", lambda: self._download("linkage (TOML)")))
        keep.on_click(lambda _: worker.ask("keep", self._keep))
        self._replace.on_click(lambda _: worker.ask("keep", lambda: self._keep(replace=True)))
        on_change(self._file, worker, "file", lambda _: self._forget())
        self._named: object = None
        write.on_click(lambda _: worker.ask("export", lambda: self._download(self._kind.value)))

    def _chosen(self, words: str) -> None:
        if words != CHOOSE:
            name = self._names[words]
            self._opened(lambda: toml_text(name), name)

    def _uploaded(self, _: viser.GuiEvent[Any]) -> None:
        file = self._open.value
        self._worker.ask("open", lambda: self._opened(lambda: decoded(file.content, file.name), file.name))
        put(self._gallery, CHOOSE)

    def _opened(self, read: Any, source: str) -> None:
        self._alert.tried(lambda: self._session.open(read(), source))

    def show(self) -> None:
        """Shows the file that `Save` writes: the one that was opened, or one named like the linkage."""
        draft = self._session.draft
        if draft.text is not self._named:
            self._named = draft.text
            put(self._file, f"{Scene.of(self._session).stem}{ENDING}")
            self._forget()

    def _forget(self) -> None:
        """Takes back the question whether a file is to be replaced."""
        self._replace.visible = False
        self._kept.clear()

    def _keep(self, *, replace: bool = False) -> None:
        """Saves the description; a file that is not as it is known is replaced only on demand."""
        if self._shelf is None:
            return
        name, text = self._file.value, self._session.draft.toml()
        self._forget()
        try:
            path = self._shelf.save(name, text, replace=replace)
        except ChangedError as error:
            self._kept.tell(str(error))
            self._replace.visible = True
        except SevenbarError as error:
            self._kept.tell(str(error))
        else:
            put(self._file, path.name)
            self._client.add_notification("Saved", str(path), auto_close_seconds=4.0)

    def _download(self, kind: str) -> None:
        scene = Scene.of(self._session)
        # figures and bodies take seconds, in which the linkage should go on moving
        threading.Thread(target=self._send, args=(kind, scene), daemon=True).start()

    def _send(self, kind: str, scene: Scene) -> None:
        waiting = self._client.add_notification(
            f"Writing {kind}", "The browser will save it.", loading=True, with_close_button=False
        )
        try:
            name, content = DOWNLOADS[kind](scene)
        except SevenbarError as error:
            message = str(error)
            self._worker.ask("shown", lambda: self._unsaved.tell(message))
        except Exception:
            traceback.print_exc()
            fault = f"{kind}: this is a fault of Sevenbar; please report the lines in the terminal"
            self._worker.ask("shown", lambda: self._unsaved.tell(fault))
        else:
            self._client.send_file_download(name, content, save_immediately=True)
            self._worker.ask("shown", self._unsaved.clear)
        finally:
            waiting.remove()
