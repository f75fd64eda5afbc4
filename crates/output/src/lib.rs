//! Result files of a jstsph run: ParaView frames, tables, summaries, restart files, pictures.
