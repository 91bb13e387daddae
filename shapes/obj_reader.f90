module obj_reader
  !! Quadrilateral meshes from Wavefront OBJ text: lines `v x y z` and `f a b c d`, where a vertex
  !! may
  !! be followed by /texture/normal and be counted backwards (-1 is the last one so far). Texture
  !! coordinates, normals, groups, objects, materials and smoothing groups have no meaning here and
  !! are passed over. Faces of other than four vertices are problems.
  use kinds, only: wp
  use extraction_mesh, only: problem_list, whole_number, printable
  use growing_arrays, only: make_room
  use text_scanner, only: scanner_type
  implicit none (type, external)
  private
  public :: read_obj

contains

  subroutine read_obj(text, x, faces, line, problems)
    character(*), intent(in) :: text                     !! the file
    real(wp), allocatable, intent(out) :: x(:,:)         !! vertices (3,nv) [length]
    integer, allocatable, intent(out) :: faces(:,:)      !! vertices of faces (4,nf)
    integer, allocatable, intent(out) :: line(:)         !! of each face in the file (nf)
    type(problem_list), intent(inout) :: problems

    type(scanner_type) :: file
    character(:), allocatable :: word
    real(wp), allocatable :: points(:,:)
    integer, allocatable :: corners(:)
    integer :: nf, nv
    logical :: found

    allocate (points(3,0), corners(0), line(0))
    nf = 0
    nv = 0
    call file%open(text, '#')
    do
      call file%next_line(found)
      if (.not. found) exit
      call file%next_word(word)
      select case (word)
      case ('v')
        nv = nv + 1
        call make_room(points, nv)
        call read_vertex(file, points(:,nv), problems)
      case ('f')
        nf = nf + 1
        call make_room(corners, 4*nf)
        call make_room(line, nf)
        line(nf) = file%line
        call read_face(file, nv, corners(4*nf-3:4*nf), problems)
      case ('vt', 'vn', 'vp', 'g', 'o', 's', 'usemtl', 'mtllib', 'l', 'p')
        cycle
      case default
        call problems%add(file%line, 'a line begins with "' // printable(word) // '"', &
          'Meshes are read from the lines v and f of OBJ files')
        if (problems%count > 5) exit
      end select
    end do
    allocate (x(3,nv), source=points(:,1:nv))
    allocate (faces(4,nf), source=reshape(corners(1:4*nf), [4, nf]))
    line = line(1:nf)
    if (nf == 0 .and. problems%count == 0) call problems%add(0, 'the file has no faces', &
      'Faces are lines f a b c d')
    if (problems%count > 0) return
    call check_range(faces, nv, line, problems)
  end subroutine read_obj

  subroutine read_vertex(file, x, problems)
    type(scanner_type), intent(inout) :: file
    real(wp), intent(out) :: x(3)
    type(problem_list), intent(inout) :: problems

    real(wp) :: values(7)
    character(:), allocatable :: word
    integer :: n

    ! further numbers are a weight, which only curves of the format have, or colours
    call file%read_rest(values, n, word)
    x = values(1:3)
    if (len(word) > 0) then
      call problems%add(file%line, '"' // printable(word) // '" is no coordinate', &
        'A vertex is v x y z')
    else if (n < 3) then
      call problems%add(file%line, 'a vertex has ' // whole_number(n) // ' coordinates', &
        'A vertex is v x y z')
    else if (any(abs(x) > huge(1.0_wp))) then
      call problems%add(file%line, 'a coordinate is infinite', '')
    end if
  end subroutine read_vertex

  subroutine read_face(file, nv, corners, problems)
    type(scanner_type), intent(inout) :: file
    integer, intent(in) :: nv                    !! vertices so far
    integer, intent(out) :: corners(4)
    type(problem_list), intent(inout) :: problems

    character(:), allocatable :: word
    integer :: code, id, n, slash

    corners = 0
    n = 0
    do
      call file%next_word(word)
      if (len(word) == 0) exit
      slash = index(word, '/')
      if (slash == 0) slash = len(word) + 1
      id = 0
      code = 1
      if (slash > 1 .and. slash < 13 .and. verify(word(1:slash-1), '+-0123456789') == 0) &
        read (word(1:slash-1), '(i12)', iostat=code) id
      if (code /= 0 .or. id == 0) then
        call problems%add(file%line, '"' // printable(word) // '" is no vertex of a face', &
          'Vertices are counted from 1, or backwards from -1')
        return
      end if
      if (id < 0) id = nv + 1 + id
      n = n + 1
      if (n <= 4) corners(n) = id
      if (id < 1) then
        call problems%add(file%line, 'a face names a vertex before the first one', '')
        return
      end if
    end do
    if (n == 4) return
    if (n == 3) then
      call problems%add(file%line, 'a face is a triangle', &
        'All faces need four vertices: subdivide the mesh once (Catmull-Clark), or remesh it')
    else
      call problems%add(file%line, 'a face has ' // whole_number(n) // ' vertices', &
        'All faces need four; T-junctions are not read from OBJ files')
    end if
  end subroutine read_face

  subroutine check_range(faces, nv, line, problems)
    !! Vertices may follow the faces that name them.
    integer, intent(in) :: faces(:,:), nv, line(:)
    type(problem_list), intent(inout) :: problems

    integer :: f

    do f = 1, size(faces, 2)
      if (any(faces(:,f) > nv)) call problems%add(line(f), 'face ' // whole_number(f) // &
        ' names vertex ' // whole_number(maxval(faces(:,f))) // ', which does not exist', &
        'The file has ' // whole_number(nv) // ' vertices')
    end do
  end subroutine check_range
end module obj_reader
