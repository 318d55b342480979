from auvid_validation.cli import main

main()
